// The program `lightwell-viewer`. Exit codes: 0 done; 1 the work failed (display, device, disk); 2 a wrong argument.
#include <fmt/format.h>

#include <cstdio>
#include <new>

#include "app.h"

namespace {

int run(int argc, char** argv) {
    viewer::Options options;
    if (!viewer::parseOptions(argc, argv, options)) return 0;
    const auto context = options.isHeadless ? viewer::makeHeadlessContext(options.width, options.height)
                                            : viewer::makeWindow(options.width, options.height, "Lightwell");
    viewer::App app(options, *context);
    app.run();
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const viewer::UsageError& error) {
        fmt::print(stderr, "lightwell-viewer: {}\n", error.what());
        return 2;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "lightwell-viewer: out of memory; a smaller --size needs less\n");
        return 1;
    } catch (const std::exception& error) {
        fmt::print(stderr, "lightwell-viewer: {}\n", error.what());
        return 1;
    }
}
