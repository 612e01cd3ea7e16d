/* lightwell.h is C99: compiled with -std=c99 -pedantic -Werror, and LW_INIT, the default functions and a
 * first call work from C. */
#include "lightwell/lightwell.h"

int lwTestHeaderFromC(void);

int lwTestHeaderFromC(void) {
    LWFrame frame;
    LWDeviceDesc device;
    LWRsmDesc rsm;
    const char* message = 0;
    frame.lightCount = 77;
    LW_INIT(frame);
    if (frame.structSize != sizeof frame || frame.lightCount != 0 || frame.lights != 0) return 1;
    lwDefaultDevice(&device);
    if (device.structSize != sizeof device) return 2;
    lwDefaultRsm(&rsm);
    if (rsm.structSize != sizeof rsm || rsm.vpls == 0) return 3;
    if (lwFinish(0) != LW_ERROR_INVALID_HANDLE) return 4;
    if (lwGetLastError(0, &message) != LW_ERROR_INVALID_HANDLE || !message || !message[0]) return 5;
    if (lwGetLastError(0, 0) != LW_SUCCESS) return 6;
    return 0;
}
