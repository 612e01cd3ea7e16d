// Ctrl-C asks long work to stop at its next safe point, where it has saved what it has.
#pragma once

#include <stdexcept>

namespace cli {

constexpr int kInterruptedExitCode = 130;  // 128 + SIGINT, as shells report it

struct Interrupted : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// While it lives, the first Ctrl-C only raises a flag; the second ends the program at once.
class InterruptGuard {
public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
    static bool wasRaised();
};

}  // namespace cli
