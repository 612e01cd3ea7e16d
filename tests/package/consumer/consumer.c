/* The least that shows header, link and run time to fit together. Exit code 0: they do. */
#include <lightwell/lightwell.h>
#include <stdio.h>
#include <string.h>

int main(void) {
    char header[32];
    uint32_t devices = 0, technique;
    LWStatus status = lwCountDevices(&devices);
    snprintf(header, sizeof header, "%d.%d.%d", LW_VERSION_MAJOR, LW_VERSION_MINOR, LW_VERSION_PATCH);
    printf("lightwell %s (header %s), %s, %u devices\n", lwVersion(), header, lwStatusName(status),
           devices);
    for (technique = 0; technique < lwCountTechniques(); ++technique) {
        LWTechniqueInfo info;
        LW_INIT(info);
        if (lwDescribeTechnique(technique, &info) != LW_SUCCESS) return 1;
        printf("technique %s: %s\n", info.name, info.summary);
    }
    return strcmp(lwVersion(), header) != 0 || status != LW_SUCCESS;
}
