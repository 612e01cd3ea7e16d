// The command line of the viewer. docs/viewer.md.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "compose.h"
#include "indirect.h"

namespace viewer {

struct Options {
    std::string scene = "cornell", camera, device, path, truth, screenshot, out;
    int width = 1280, height = 720;
    float time = 0.0f, step = -1.0f;  // s; from frame to frame without a window, below 0: that of a path, else none
    Settings settings;
    Look look;
    int rsmSize = 512, shadowSize = 2048;
    bool isHeadless = false, wantsCopies = false, hasPanels = true, asJson = false, checks = false;
    int frames = 0, warmUp = 2;  // 0 frames: until the window is closed; headless: 1
    std::string debugView;
};

struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// False: help was asked for and has been printed. UsageError names what is wrong and what is valid.
bool parseOptions(int argc, char** argv, Options& options);

}  // namespace viewer
