// Which candidate runs next, frame by frame: predictions corrected by what was measured, held to a budget, with hysteresis.
//
//     each frame:  steering.ran(candidate, predicted ms, its ms, the frame's ms);    // of frames that the device has done since
//                  const SteeringStep step = steering.next(predictions, mayLeave);
//
// Pure arithmetic; docs/techniques/auto.md derives it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "planner/planner.h"

namespace lightwell {

struct SteeringOptions {
    double budgetMilliseconds = 0.0;  // 0: none
    double errorTarget = 0.0;         // 0: none
    std::uint32_t patience = 30;      // frames
    double gain = 0.1;
    std::vector<std::size_t> groups;  // of each candidate: those of one are likely to be off alike; none: each is its own
};

// Why a candidate runs.
enum class SteeringCause {
    kStart,       // the first, or all was forgotten
    kKept,
    kBetter,      // less error, for as long as patience says
    kCheaper,     // reaches the target, for less
    kOverBudget,  // the one before broke the budget
    kTooDear,     // what the frame brings makes the one before dearer than the budget
    kNotPossible  // the frame does not allow the one before, or it failed
};

struct SteeringStep {
    Prediction prediction;
    double expected = 0.0;   // ms, here and now: predicted by the tables, corrected by what was measured
    double highest = 0.0;    // ... what 95 % of its frames stay within
    bool isWithinBudget = true, reachesError = true;
    bool isLeaving = false;  // another would run, had it been allowed to start
    SteeringCause cause = SteeringCause::kStart;
};

class Steering {
public:
    explicit Steering(const SteeringOptions& options) : options_(options) {}

    // A frame of `candidate` that the device has done: what it took, and the whole frame with it. Those that cannot be told (not above
    // 0) are left out.
    void ran(std::size_t candidate, double predictedMilliseconds, double milliseconds, double frameMilliseconds);
    // Of the next frame; nothing where all that it allows is barred for having failed. Without `mayLeave` what runs stays, if the frame
    // allows it, and the same is asked again in the next frame.
    std::optional<SteeringStep> next(const std::vector<Prediction>& predictions, bool mayLeave = true);
    // It has failed: not to be chosen for a while, twice as long each time.
    void fail(std::size_t candidate);
    // It runs instead of what next() said.
    void resume(std::size_t candidate);
    // What runs was chosen without knowing the frame: the next choice is free.
    void forgetChoice() { running_.reset(); }

    // Whether the next step may be to leave what runs: a frame over the budget, or patience all but at its end.
    bool mayLeave() const;
    std::size_t barred() const;  // candidates
    double load() const;         // how many times as long as predicted this device takes

private:
    struct Known {
        double bias = 0.0;           // logarithm of measured over predicted, beyond the device's load
        std::uint32_t learnt = 0;    // frames that it was learnt from
        std::uint32_t toSettle = 0;  // frames of this stint that are not to be judged by
        double predicted = 0.0;      // ms, of its last frame
        std::deque<double> recent;   // last logarithms of this stint
        std::uint64_t barredUntil = 0, barLength = 0;
        bool hasFailed = false;
    };
    struct Expected {
        Prediction prediction;
        double median, high;
    };

    Expected expect(const Prediction& prediction) const;
    void learn(Known& known, double ratio);
    double guessBias(const Prediction& prediction) const;
    bool isBlind() const;
    std::size_t groupOf(std::size_t candidate) const;
    double spread() const;
    bool breaksBudget() const;
    bool isBarred(const Known& known) const { return known.barredUntil > frame_; }
    std::vector<Expected> possible(const std::vector<Prediction>& predictions) const;
    bool fits(const Expected& one) const;
    bool reaches(const Expected& one) const;
    bool isBetter(const Expected& one, const Expected& running) const;
    bool isQuicker(const Expected& one, const Expected& running) const;
    bool isPreferred(const Expected& one, const Expected& other) const;
    const Expected* best(const std::vector<Expected>& expected, std::optional<std::size_t> without) const;
    // What to leave the running one for, and why; null: stay.
    const Expected* leaveFor(const Expected& running, const std::vector<Expected>& expected, SteeringCause& cause);
    SteeringStep start(const Expected& one, SteeringCause cause);
    SteeringStep stepOf(const Expected& one, SteeringCause cause) const;
    void bar(std::size_t candidate, bool hasFailed);

    SteeringOptions options_;
    std::uint64_t frame_ = 0, startedAt_ = 0;
    std::optional<std::size_t> running_;
    std::map<std::size_t, Known> known_;
    double load_ = 0.0;  // logarithm
    bool isAnchored_ = false;         // some candidate has told the load
    std::deque<double> residuals_;    // logarithms of measured over expected, of all that ran
    double beside_ = 0.0;             // ms of a frame that are not its candidate's, in the mean: fading, probing
    std::deque<bool> over_;           // of this stint's last frames: over the budget
    std::uint32_t overRow_ = 0, better_ = 0;
    bool startedBlind_ = false;  // what runs was chosen before any frame was measured
    bool canLeave_ = true;  // there is another that fits, or is quicker
};

}  // namespace lightwell
