/* The public header is C99 by itself, and LW_INIT works as it says. */
#include <lightwell/lightwell.h>

#include "../../samples/large_world.h"

void headerCheck(void);
void headerCheck(void) {
    LWFrame frame;
    LW_INIT(frame);
    (void)frame;
}
