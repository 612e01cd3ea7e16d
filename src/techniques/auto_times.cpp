#include "techniques/auto_times.h"

#include <algorithm>
#include <utility>

namespace lightwell {
namespace {

// Frames whose times are waited for at most: a device that is further behind tells too late to steer by.
constexpr std::size_t kMostPending = 16;

}  // namespace

void AutoTimes::startFrame(std::size_t candidate, double predicted) {
    pending_.emplace_back();
    pending_.back().frame = {candidate, predicted, 0.0, 0.0, false};
    if (pending_.size() > kMostPending) pending_.pop_front();
}

void AutoTimes::keep() {
    if (!pending_.empty()) pending_.back().frame.isKept = true;
}

void AutoTimes::discard() {
    if (!pending_.empty()) pending_.back().isDiscarded = true;
}

void AutoTimes::begin(Executor& executor, bool part) {
    (part ? part_ : whole_).begin(executor);
}

void AutoTimes::end(Executor& executor, bool part) {
    CallSpan& span = part ? part_ : whole_;
    span.end(executor);
    if (!pending_.empty()) (part ? pending_.back().parts : pending_.back().wholes).push_back(std::move(span));
    span = CallSpan();
}

double AutoTimes::sum(const std::vector<CallSpan>& spans, std::int64_t doneBefore) {
    double milliseconds = 0.0;
    for (const CallSpan& span : spans) milliseconds += span.milliseconds(doneBefore);
    return milliseconds;
}

std::optional<AutoTimes::Frame> AutoTimes::take() {
    const auto isDone = [](const CallSpan& span) { return span.isDone(); };
    while (!pending_.empty()) {
        Pending& oldest = pending_.front();
        if (!std::all_of(oldest.wholes.begin(), oldest.wholes.end(), isDone) ||
            !std::all_of(oldest.parts.begin(), oldest.parts.end(), isDone))
            return std::nullopt;
        Frame frame = oldest.frame;
        frame.part = sum(oldest.parts, doneBefore_);
        frame.whole = 0.0;
        for (const CallSpan& span : oldest.wholes) frame.whole += span.milliseconds(doneBefore_);
        // A frame of which no view was rendered is no frame that a budget is for.
        const bool counts = !oldest.isDiscarded && oldest.wholes.size() > 1;
        pending_.pop_front();
        if (counts) return frame;
    }
    return std::nullopt;
}

}  // namespace lightwell
