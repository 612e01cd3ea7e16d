// Over 300 lines: a third are constants, each with what larger and smaller ones do.
#include "planner/steering.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

// Frames over the budget in a row that make a candidate go. 1: every hiccup of the system is a switch. 3: a jump of the load shows a
// frame longer.
constexpr std::uint32_t kOverRow = 2;
// ... or so many of the last kOverWindow: more than the 5 % that may be. Shorter windows switch by chance, longer ones late.
constexpr std::size_t kOverWindow = 40;
constexpr int kOverInWindow = 3;
// First frames of a stint that are not judged: they make buffers and tables that later ones have. Fewer: what costs much only once is
// sent away. More: what breaks the budget stays as much longer.
constexpr std::uint32_t kSettle = 2;
// Frames whose median is what a candidate takes now. Longer: follows a change later. Shorter: follows noise.
constexpr std::size_t kRecent = 5;
// ... and from which on noise is told from it. Fewer: what was not known yet is taken for noise.
constexpr std::size_t kFewRecent = 3;
// Frames from which a candidate's own part is learnt; later changes are the device's load, which all share. Longer: a change of load
// meanwhile is taken for the candidate's own. Shorter: its own part is as uncertain as a few frames are.
constexpr std::uint32_t kLearning = 5;
// Frames that the spread is known from, and the share of them that shall be within the budget. A longer memory keeps a margin for noise
// that has gone; a higher share leaves more of the budget unused.
constexpr std::size_t kResiduals = 64;
constexpr std::size_t kFewResiduals = 16;
constexpr double kShare = 0.95;
// The spread before enough frames have told, and its least: a device that has been even is not trusted to stay so.
const double kFirstSpread = std::log(1.15), kLeastSpread = std::log(1.03);
// How far off the predicted time of a candidate that has not run may be: at first that much is added, and in the course of so many
// patiences in which nothing changes it becomes as much taken off, for else what is cheaper than it seems would never be found. Larger,
// or sooner: more tries that break the budget. Smaller, or later: less of it is used.
constexpr double kUntried = 0.15, kCurious = 8.0;
// How many times as long as predicted the first one may take, of which nothing is known: neither this machine's load nor what its
// technique takes of moving lights (twice and more where maps are drawn anew). It is left for what fits as soon as it has been learnt
// from. Larger: worse light for the first frames. Smaller: they break the budget.
constexpr double kBlind = 2.0;
// What a candidate must be within to be entered, of the budget. Nearer to 1: those that just fit come and go.
constexpr double kEnter = 0.95;
// By how much one that does not fit either must be quicker. Nearer to 1: two of them swing.
constexpr double kQuicker = 1.1;
// First bar in patiences, and the longest. Shorter: what breaks the budget comes back as often. Longer: good ones are missed for as long.
constexpr std::uint64_t kBar = 4, kLongestBar = 128;
// Share of a frame in the mean of what lies beside candidates (fades, probes), for which room is left. Larger: a single fade sends a
// candidate away. Smaller: many fades after each other are not made room for.
constexpr double kBesideShare = 1.0 / 64.0;

// Of two in the middle their mean.
double median(std::deque<double> values) {
    std::sort(values.begin(), values.end());
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

bool isTime(double milliseconds) { return milliseconds > 0.0 && std::isfinite(milliseconds); }

void keepLast(std::deque<double>& values, double value, std::size_t count) {
    values.push_back(value);
    if (values.size() > count) values.pop_front();
}

}  // namespace

double Steering::spread() const {
    if (residuals_.empty()) return kFirstSpread;
    std::vector<double> sorted(residuals_.begin(), residuals_.end());
    std::sort(sorted.begin(), sorted.end());
    const double known = std::max(sorted[std::min(std::size_t(kShare * double(sorted.size())), sorted.size() - 1)], kLeastSpread);
    return sorted.size() < kFewResiduals ? std::max(known, kFirstSpread) : known;
}

double Steering::load() const { return std::exp(load_); }

std::size_t Steering::barred() const {
    return std::size_t(std::count_if(known_.begin(), known_.end(), [&](const auto& one) { return isBarred(one.second); }));
}

std::size_t Steering::groupOf(std::size_t candidate) const {
    return candidate < options_.groups.size() ? options_.groups[candidate] : candidate;
}

// Of one that has not run: as those of its group that have, between the next cheaper and the next dearer one (what a model leaves out
// grows with what it is about: maps, of ssvp), else as all that have: the lower of the two in the middle, for a wrong guess upwards is
// never found out.
double Steering::guessBias(const Prediction& prediction) const {
    const Known *cheaper = nullptr, *dearer = nullptr;
    std::vector<double> all;
    for (const auto& [other, known] : known_) {
        if (known.learnt == 0) continue;
        all.push_back(known.bias);
        if (groupOf(other) != groupOf(prediction.candidate)) continue;
        if (known.predicted <= prediction.milliseconds && (!cheaper || known.predicted > cheaper->predicted)) cheaper = &known;
        if (known.predicted >= prediction.milliseconds && (!dearer || known.predicted < dearer->predicted)) dearer = &known;
    }
    if (cheaper && dearer && cheaper->predicted < dearer->predicted) {
        const double part = std::log(prediction.milliseconds / cheaper->predicted) / std::log(dearer->predicted / cheaper->predicted);
        return cheaper->bias + part * (dearer->bias - cheaper->bias);
    }
    if (cheaper || dearer) return (cheaper ? cheaper : dearer)->bias;
    if (all.empty()) return 0.0;
    std::sort(all.begin(), all.end());
    return all[(all.size() - 1) / 2];
}

// No frame of any has told anything.
bool Steering::isBlind() const {
    return std::none_of(known_.begin(), known_.end(), [](const auto& one) { return one.second.learnt > 0; });
}

Steering::Expected Steering::expect(const Prediction& prediction) const {
    const auto found = known_.find(prediction.candidate);
    const bool tried = found != known_.end() && found->second.learnt > 0;
    const double middle = prediction.milliseconds * std::exp(load_ + (tried ? found->second.bias : guessBias(prediction)));
    const double calm = running_ ? double(frame_ - startedAt_) / (kCurious * std::max(options_.patience, 1u)) : 0.0;
    const double doubt = tried ? 1.0 : isBlind() ? kBlind : 1.0 + kUntried * (2.0 * std::exp(-calm) - 1.0);
    return {prediction, middle, middle * std::exp(spread()) * doubt};
}

// The first candidate tells the load; another's first frames tell how it differs, and then the load again.
void Steering::learn(Known& known, double ratio) {
    keepLast(known.recent, ratio, kRecent);
    // One frame alone may be a hiccup: half of it, and half of what was known before.
    const bool isAlone = known.recent.size() == 1 && isAnchored_;
    const double level = isAlone ? 0.5 * (ratio + load_ + known.bias) : median(known.recent);
    if (known.learnt >= kLearning || !isAnchored_) load_ = level - known.bias;
    else known.bias = level - load_;
    if (++known.learnt >= kLearning) isAnchored_ = true;
}

void Steering::ran(std::size_t candidate, double predictedMilliseconds, double milliseconds, double frameMilliseconds) {
    // Of what has gone nothing is learnt.
    if (!isTime(predictedMilliseconds) || !isTime(milliseconds) || !isTime(frameMilliseconds) || running_ != candidate) return;
    Known& known = known_[candidate];
    if (known.toSettle > 0) {
        --known.toSettle;
        return;
    }
    beside_ += kBesideShare * (std::max(frameMilliseconds - milliseconds, 0.0) - beside_);
    const double ratio = std::log(milliseconds / predictedMilliseconds);
    known.predicted = predictedMilliseconds;
    // What a fade takes is no fault of the candidate's.
    const bool isOver = options_.budgetMilliseconds > 0.0 && milliseconds > options_.budgetMilliseconds;
    overRow_ = isOver ? overRow_ + 1 : 0;
    over_.push_back(isOver);
    if (over_.size() > kOverWindow) over_.pop_front();
    // From what this stint has shown: what the load is taken to be may yet be far off.
    if (known.recent.size() >= kFewRecent) keepLast(residuals_, ratio - median(known.recent), kResiduals);
    if (overRow_ == kOverRow && !known.recent.empty()) {
        // A jump, not noise: the last frames alone say where to, and their distance from what was says nothing of the spread.
        const double last = known.recent.back();
        for (std::uint32_t i = 0; i < kOverRow && !residuals_.empty(); ++i) residuals_.pop_back();
        known.recent.clear();
        known.recent.push_back(std::min(last, ratio));
    }
    learn(known, ratio);
}

bool Steering::breaksBudget() const {
    return overRow_ >= kOverRow || std::count(over_.begin(), over_.end(), true) >= kOverInWindow;
}

bool Steering::mayLeave() const {
    if (!running_) return false;
    const bool isOver = overRow_ > 0 || std::count(over_.begin(), over_.end(), true) + 1 >= kOverInWindow;
    const bool isDue = better_ > 0 && (better_ + 2 > options_.patience || (startedBlind_ && known_.at(*running_).learnt + 1 >= kLearning));
    return (isOver && canLeave_) || isDue || options_.patience == 0;
}

bool Steering::fits(const Expected& one) const {
    return !(options_.budgetMilliseconds > 0.0) || one.high + beside_ <= kEnter * options_.budgetMilliseconds;
}

bool Steering::reaches(const Expected& one) const {
    return !(options_.errorTarget > 0.0) || one.prediction.error <= options_.errorTarget;
}

// Where neither fits. One that has not run may be quicker than it seems.
bool Steering::isQuicker(const Expected& one, const Expected& running) const {
    const auto found = known_.find(one.prediction.candidate);
    const bool tried = found != known_.end() && found->second.learnt > 0;
    const bool isTold = known_.at(running.prediction.candidate).recent.size() >= kOverRow;  // what runs has shown how quick it is
    return isTold && one.median * (tried ? kQuicker : 1.0 - kUntried) < running.median;
}

// Of two that fit the budget.
bool Steering::isPreferred(const Expected& one, const Expected& other) const {
    if (options_.errorTarget > 0.0) {
        if (reaches(one) != reaches(other)) return reaches(one);
        if (reaches(one)) return one.median < other.median;
    }
    return one.prediction.error < other.prediction.error;
}

// ... of the one that runs, by enough.
bool Steering::isBetter(const Expected& one, const Expected& running) const {
    const double gain = 1.0 + options_.gain;
    if (options_.errorTarget > 0.0) {
        if (reaches(one) != reaches(running)) return reaches(one);
        if (reaches(one)) return one.median * gain < running.median;
    }
    return one.prediction.error * gain < running.prediction.error;
}

// Those that are not barred. What broke the budget is better than nothing, what failed is not.
std::vector<Steering::Expected> Steering::possible(const std::vector<Prediction>& predictions) const {
    std::vector<Expected> expected;
    for (const bool all : {false, true}) {
        for (const Prediction& prediction : predictions) {
            const auto found = known_.find(prediction.candidate);
            const bool isOut = found != known_.end() && isBarred(found->second) && (!all || found->second.hasFailed);
            if (!isOut && prediction.milliseconds >= 0.0 && std::isfinite(prediction.milliseconds)) expected.push_back(expect(prediction));
        }
        if (!expected.empty()) break;
    }
    return expected;
}

// The preferred of those that fit; of none the quickest.
const Steering::Expected* Steering::best(const std::vector<Expected>& expected, std::optional<std::size_t> without) const {
    const Expected *found = nullptr, *quickest = nullptr;
    for (const Expected& one : expected) {
        if (without == one.prediction.candidate) continue;
        if (!quickest || one.high < quickest->high) quickest = &one;
        if (fits(one) && (!found || isPreferred(one, *found))) found = &one;
    }
    return found ? found : quickest;
}

SteeringStep Steering::stepOf(const Expected& one, SteeringCause cause) const {
    SteeringStep step;
    step.prediction = one.prediction;
    step.expected = one.median;
    step.highest = one.high;
    step.isWithinBudget = !(options_.budgetMilliseconds > 0.0) || one.high <= options_.budgetMilliseconds;
    step.reachesError = reaches(one);
    step.cause = cause;
    return step;
}

void Steering::resume(std::size_t candidate) {
    // However short the first one ran: what the next takes longer or shorter is then its own.
    const auto before = running_ ? known_.find(*running_) : known_.end();
    isAnchored_ |= before != known_.end() && before->second.learnt > 0 && running_ != candidate;
    running_ = candidate;
    startedBlind_ = isBlind();
    startedAt_ = frame_;
    over_.clear();
    overRow_ = better_ = 0;
    canLeave_ = true;
    Known& known = known_[candidate];
    known.toSettle = kSettle;
    known.recent.clear();
}

SteeringStep Steering::start(const Expected& one, SteeringCause cause) {
    resume(one.prediction.candidate);
    return stepOf(one, cause);
}

void Steering::bar(std::size_t candidate, bool hasFailed) {
    Known& known = known_[candidate];
    const std::uint64_t shortest = kBar * std::max(options_.patience, 1u), longest = kLongestBar * std::max(options_.patience, 1u);
    // What held for longer than it was barred before begins anew.
    const bool held = running_ == candidate && frame_ - startedAt_ > 2 * known.barLength;
    known.barLength = known.barLength && !held ? std::min(2 * known.barLength, longest) : shortest;
    known.barredUntil = frame_ + known.barLength;
    known.hasFailed = hasFailed;
}

void Steering::fail(std::size_t candidate) {
    bar(candidate, true);
    if (running_ == candidate) running_.reset();
}

const Steering::Expected* Steering::leaveFor(const Expected& running, const std::vector<Expected>& expected, SteeringCause& cause) {
    const bool isOver = breaksBudget();
    const Expected* other = best(expected, running_);
    canLeave_ = other && (fits(*other) || isQuicker(*other, running));
    if (isOver || (options_.budgetMilliseconds > 0.0 && running.median > options_.budgetMilliseconds)) {
        better_ = 0;
        cause = isOver ? SteeringCause::kOverBudget : SteeringCause::kTooDear;
        // Where nothing fits the quickest runs, and stays.
        return canLeave_ ? other : nullptr;
    }
    const bool isWorthIt = other && fits(*other) && isBetter(*other, running);
    better_ = isWorthIt ? better_ + 1 : 0;
    cause = options_.errorTarget > 0.0 && reaches(running) ? SteeringCause::kCheaper : SteeringCause::kBetter;
    const bool isToldNow = startedBlind_ && known_.at(running.prediction.candidate).learnt >= kLearning;
    if (isToldNow && !isWorthIt) startedBlind_ = false;
    return isWorthIt && (isToldNow || better_ > options_.patience) ? other : nullptr;
}

std::optional<SteeringStep> Steering::next(const std::vector<Prediction>& predictions, bool mayLeave) {
    ++frame_;
    const std::vector<Expected> expected = possible(predictions);
    if (expected.empty()) return std::nullopt;
    const auto running = std::find_if(expected.begin(), expected.end(),
                                      [&](const Expected& one) { return running_ == one.prediction.candidate; });
    if (running == expected.end()) {
        const SteeringCause cause = running_ ? SteeringCause::kNotPossible : SteeringCause::kStart;
        return start(*best(expected, std::nullopt), cause);
    }
    SteeringCause cause = SteeringCause::kKept;
    const Expected* other = leaveFor(*running, expected, cause);
    if (!other || !mayLeave) {
        SteeringStep step = stepOf(*running, SteeringCause::kKept);
        step.isLeaving = other != nullptr;
        return step;
    }
    if (cause == SteeringCause::kOverBudget && fits(*other)) bar(*running_, false);  // else it may yet be the quickest
    return start(*other, cause);
}

}  // namespace lightwell
