// How long technique auto's frames took, and the part of its candidate: looked at when the device has done them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "compute/call_span.h"

namespace lightwell {

class AutoTimes {
public:
    struct Frame {
        std::size_t candidate;
        double predicted;     // ms
        double part, whole;   // ms: of the candidate, and with all around it; NaN: not to be told
        bool isKept;          // its picture was kept or mixed
    };

    // A frame begins.
    void startFrame(std::size_t candidate, double predicted);
    // Its picture is kept or mixed.
    void keep();
    // It is not to be told: another candidate had a part in it, or a call broke off.
    void discard();

    // Around what a call records; `part`: the candidate's own.
    void begin(Executor& executor, bool part);
    void end(Executor& executor, bool part);

    // The oldest frame that the device has done, and that has not been taken: between two frames. Waits for nothing.
    std::optional<Frame> take();

private:
    struct Pending {
        Frame frame;
        bool isDiscarded = false;
        std::vector<CallSpan> parts, wholes;
    };
    static double sum(const std::vector<CallSpan>& spans, std::int64_t doneBefore);

    std::deque<Pending> pending_;
    CallSpan part_, whole_;
    std::int64_t doneBefore_ = 0;  // when the last frame taken was done, on the host's clock
};

}  // namespace lightwell
