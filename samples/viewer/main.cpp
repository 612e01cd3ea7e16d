// The program `lightwell-viewer`. Exit codes: 0 done; 1 the work failed (display, device, disk); 2 a wrong argument.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <new>
#include <string>

#include "app.h"

namespace {

// One line, whatever the message's own layout.
void printError(std::string message) {
    while (!message.empty() && message.back() == '\n') message.pop_back();
    std::replace(message.begin(), message.end(), '\n', ' ');
    fmt::print(stderr, "lightwell-viewer: {}\n", message);
}

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
        printError(error.what());
        return 2;
    } catch (const std::bad_alloc&) {
        printError("out of memory; a smaller --size needs less");
        return 1;
    } catch (const std::exception& error) {
        printError(error.what());
        return 1;
    }
}
