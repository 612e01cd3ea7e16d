// Steering against a simulated device: what is within the budget, how often it switches, what it comes back to.
#include "planner/steering.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <set>

using namespace lightwell;

namespace {

// Candidates as times and errors often lie: twice as long for some 0.6 of the error. `bias`: of the device, which predictions do not know.
struct Machine {
    std::vector<double> milliseconds{2, 4, 8, 14, 25, 50};
    std::vector<double> error{1.0, 0.6, 0.35, 0.2, 0.12, 0.07};
    std::vector<double> bias{1.1, 0.95, 1.0, 0.88, 0.95, 1.0};
    double noise = 0.1;  // deviation of the logarithm of a frame's time
    std::mt19937 random{7};

    std::vector<Prediction> predict(double cost = 1.0) const {
        std::vector<Prediction> predictions;
        for (std::size_t i = 0; i < milliseconds.size(); ++i) predictions.push_back({i, cost * milliseconds[i], error[i], 0.7});
        return predictions;
    }
    double run(std::size_t candidate, double cost) {
        std::normal_distribution<double> normal(0.0, noise);
        return milliseconds[candidate] * bias[candidate] * cost * std::exp(normal(random));
    }
};

struct Outcome {
    std::vector<std::size_t> ran;
    std::vector<bool> within;
    std::vector<std::size_t> switches;  // frames

    double share(std::size_t from, std::size_t to) const {
        return double(std::count(within.begin() + std::ptrdiff_t(from), within.begin() + std::ptrdiff_t(to), true)) / double(to - from);
    }
    std::size_t switched(std::size_t from, std::size_t to) const {
        return std::size_t(std::count_if(switches.begin(), switches.end(), [&](std::size_t s) { return s >= from && s < to; }));
    }
};

// `foreseen` and `unforeseen`: factors on a frame's cost that predictions know of, and those that they do not. A frame's time is known
// `late` frames later, as from a device that is asked without waiting.
Outcome drive(Steering& steering, Machine& machine, std::size_t frames, double budget, const std::function<double(std::size_t)>& foreseen,
              const std::function<double(std::size_t)>& unforeseen, std::size_t late = 2) {
    Outcome outcome;
    std::vector<double> predicted, measured;
    for (std::size_t f = 0; f < frames; ++f) {
        if (f >= late) steering.ran(outcome.ran[f - late], predicted[f - late], measured[f - late], measured[f - late]);
        const auto step = steering.next(machine.predict(foreseen(f)));
        REQUIRE(step);
        const std::size_t now = step->prediction.candidate;
        if (f > 0 && now != outcome.ran.back()) outcome.switches.push_back(f);
        outcome.ran.push_back(now);
        predicted.push_back(step->prediction.milliseconds);
        measured.push_back(machine.run(now, foreseen(f) * unforeseen(f)));
        outcome.within.push_back(!(budget > 0.0) || measured.back() <= budget);
    }
    return outcome;
}

SteeringOptions within(double budget) {
    SteeringOptions options;
    options.budgetMilliseconds = budget;
    return options;
}

double always(std::size_t) { return 1.0; }

// Frames until a jump that nothing foretold has been answered: two that are over, two until they are known, the new one's first.
constexpr std::size_t kReaction = 8;

}  // namespace

TEST_CASE("a steady scene: the best that fits is found, held within the budget, and not left", "[steering]") {
    const double budget = GENERATE(4.5, 8.0, 16.0, 33.0, 66.0);
    CAPTURE(budget);
    Machine machine;
    Steering steering(within(budget));
    const Outcome outcome = drive(steering, machine, 2000, budget, always, always);
    CHECK(outcome.share(0, 2000) >= 0.95);
    CHECK(outcome.switches.size() <= 4);
    // Nothing was left out that would have fit with its noise and what predictions were off by.
    const std::size_t last = outcome.ran.back();
    for (std::size_t i = last + 1; i < machine.milliseconds.size(); ++i)
        CHECK(machine.milliseconds[i] * machine.bias[i] * std::exp(0.1 * 1.645) * 1.15 > 0.95 * budget);
}

TEST_CASE("a device slowed to half and back, unforeseen: few frames over, few switches", "[steering]") {
    const double budget = 16.0;
    Machine machine;
    Steering steering(within(budget));
    const Outcome outcome = drive(steering, machine, 3000, budget, always, [](std::size_t f) { return f >= 1000 && f < 2000 ? 2.0 : 1.0; });
    CHECK(outcome.share(0, 1000) >= 0.95);
    CHECK(outcome.share(1000 + kReaction, 2000) >= 0.95);
    CHECK(outcome.share(2000, 3000) >= 0.95);
    CHECK(outcome.share(0, 3000) >= 0.95);  // with the frames of the reaction
    CHECK(outcome.switches.size() <= 8);
    // Of what was left for the slowness, the best comes back once it has gone.
    CHECK(outcome.ran[999] == 3);
    CHECK(outcome.ran[1999] <= 2);
    CHECK(outcome.ran[2999] == 3);
}

TEST_CASE("a scene whose cost changes: what predictions foresee breaks no frame", "[steering]") {
    const double budget = 16.0;
    Machine machine;
    Steering steering(within(budget));
    const auto cost = [](std::size_t f) { return 1.0 + 0.9 * std::sin(double(f) * 0.01); };
    const Outcome outcome = drive(steering, machine, 3000, budget, cost, always);
    CHECK(outcome.share(0, 3000) >= 0.95);
    CHECK(outcome.switches.size() <= 60);  // ten times up and down over five candidates
}

TEST_CASE("jumps at random, foreseen and not: 95 % within, no swinging between two", "[steering]") {
    const double budget = 16.0;
    Machine machine;
    machine.noise = 0.12;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0.6, 1.8);
    std::vector<double> foreseen(4000), unforeseen(4000);
    for (std::size_t f = 0; f < foreseen.size(); ++f) {
        foreseen[f] = f % 250 == 0 ? uniform(random) : foreseen[f - 1];
        unforeseen[f] = f % 700 == 0 ? uniform(random) : unforeseen[f - 1];
    }
    Steering steering(within(budget));
    const Outcome outcome =
        drive(steering, machine, foreseen.size(), budget, [&](std::size_t f) { return foreseen[f]; }, [&](std::size_t f) { return unforeseen[f]; });
    CHECK(outcome.share(0, 4000) >= 0.95);
    CHECK(outcome.switches.size() <= 60);  // 16 + 6 jumps
    std::size_t least = 4000;
    for (std::size_t i = 2; i < outcome.switches.size(); ++i) least = std::min(least, outcome.switches[i] - outcome.switches[i - 2]);
    CHECK(least > 15);  // never there and back at once
}

// 20 candidates whose models are off by 20 % in the mean, jumps of what the frame costs (foreseen) and of the load (not), five budgets.
TEST_CASE("a hundred random machines: all but two hold the budget in 95 % of what can be held, near the best that is known afterwards", "[steering]") {
    constexpr int kMachines = 100, kFrames = 1500;
    const double budgets[] = {4.0, 8.0, 16.0, 33.0, 66.0};
    double shares = 0.0, errors = 0.0, counted = 0.0;
    int missed = 0;
    std::size_t most = 0;
    for (int m = 0; m < kMachines; ++m) {
        std::mt19937 random{unsigned(m)};
        std::uniform_real_distribution<double> uniform(0.0, 1.0);
        std::normal_distribution<double> normal;
        Machine machine;
        machine.random.seed(unsigned(m) + 1000);
        machine.milliseconds.clear();
        machine.error.clear();
        machine.bias.clear();
        for (int i = 0; i < 20; ++i) {
            machine.milliseconds.push_back(1.5 * std::pow(1.25, i));
            machine.error.push_back(std::pow(machine.milliseconds.back(), -0.7) * std::exp(0.3 * normal(random)));
            machine.bias.push_back(std::exp(0.2 * normal(random)));
        }
        std::vector<double> cost(kFrames, 1.0), load(kFrames, 1.0);
        for (std::size_t f = 1; f < cost.size(); ++f) {
            cost[f] = f % 200 == 0 ? 0.6 + 1.2 * uniform(random) : cost[f - 1];
            load[f] = f % 300 == 0 ? 0.6 + 1.4 * uniform(random) : load[f - 1];
        }
        const double budget = budgets[m % 5];
        Steering steering(within(budget));
        const Outcome outcome = drive(steering, machine, kFrames, budget, [&](std::size_t f) { return cost[f]; }, [&](std::size_t f) { return load[f]; });
        std::size_t held = 0;
        for (std::size_t f = 0; f < cost.size(); ++f) {
            double best = std::numeric_limits<double>::infinity();  // of those that fit with their noise
            for (std::size_t i = 0; i < machine.error.size(); ++i)
                if (1.2 * cost[f] * load[f] * machine.milliseconds[i] * machine.bias[i] <= budget) best = std::min(best, machine.error[i]);
            held += outcome.within[f] || std::isinf(best);
            if (std::isinf(best)) continue;
            errors += machine.error[outcome.ran[f]] / best;
            counted += 1.0;
        }
        const double share = double(held) / kFrames;
        shares += share / kMachines;
        missed += share < 0.95;
        most = std::max(most, outcome.switches.size());
    }
    CHECK(shares >= 0.98);
    CHECK(missed <= 2);
    CHECK(most <= 20);
    CHECK(errors / counted <= 1.25);
}

TEST_CASE("a candidate that is dearer than its prediction: tried ever more seldom", "[steering]") {
    Machine machine;
    machine.bias[3] = 1.6;  // 22 ms instead of 14
    SteeringOptions options = within(16.0);
    Steering steering(options);
    const Outcome outcome = drive(steering, machine, 3000, 16.0, always, always);
    CHECK(outcome.share(0, 3000) >= 0.95);
    CHECK(outcome.switches.size() <= 4);
    CHECK(outcome.ran.back() == 2);
}

TEST_CASE("errors that tremble by less than the gain switch nothing, and by more only with patience", "[steering]") {
    SteeringOptions options;
    options.patience = 10;
    Steering steering(options);
    const auto between = [](double a, double b) { return std::vector<Prediction>{{0, 5.0, a, 0.7}, {1, 5.0, b, 0.7}}; };
    REQUIRE(steering.next(between(0.1, 0.11))->prediction.candidate == 0);
    for (int i = 0; i < 100; ++i) CHECK(steering.next(i % 2 ? between(0.1, 0.095) : between(0.095, 0.1))->prediction.candidate == 0);
    for (int i = 0; i < 200; ++i) CHECK(steering.next(i % 10 < 9 ? between(0.2, 0.1) : between(0.1, 0.2))->prediction.candidate == 0);
    for (int i = 0; i < 9; ++i) CHECK(steering.next(between(0.2, 0.1))->prediction.candidate == 0);
    std::size_t frames = 0;
    while (steering.next(between(0.2, 0.1))->prediction.candidate == 0) REQUIRE(++frames < 4);
    CHECK(steering.next(between(0.2, 0.1))->cause == SteeringCause::kKept);
}

TEST_CASE("with a target: the cheapest that reaches it, else the most accurate within the budget", "[steering]") {
    Machine machine;
    machine.bias.assign(6, 1.0);
    SteeringOptions options = within(33.0);
    options.errorTarget = 0.3;
    Steering steering(options);
    const Outcome outcome = drive(steering, machine, 300, 33.0, always, always);
    CHECK(outcome.ran.back() == 3);  // 0.2 in 14 ms
    options.errorTarget = 0.05;
    Steering unreachable(options);
    const Outcome most = drive(unreachable, machine, 300, 33.0, always, always);
    CHECK(most.ran.back() == 4);
    CHECK_FALSE(unreachable.next(machine.predict())->reachesError);
}

TEST_CASE("what is off for one of a group is off for all of it: they are not tried one after the other", "[steering]") {
    Machine machine;
    machine.milliseconds = {3, 10, 10.5, 11, 11.5, 12};
    machine.error = {1.0, 0.1, 0.099, 0.098, 0.097, 0.096};
    machine.bias = {1.0, 5.0, 5.0, 5.0, 5.0, 5.0};
    SteeringOptions options = within(16.0);
    options.groups = {0, 1, 1, 1, 1, 1};
    Steering steering(options);
    const Outcome outcome = drive(steering, machine, 2000, 16.0, always, always);
    CHECK(outcome.ran.back() == 0);
    CHECK(outcome.switches.size() <= 3);
    CHECK(outcome.share(0, 2000) >= 0.98);
}

TEST_CASE("the first is chosen for twice its time, and left for what fits as soon as it has been measured", "[steering]") {
    Machine machine;
    machine.bias.assign(6, 1.2);
    Steering steering(within(33.0));
    const Outcome outcome = drive(steering, machine, 200, 33.0, always, always);
    CHECK(outcome.ran.front() == 2);  // 8 ms; not 14
    REQUIRE(outcome.switches.size() >= 1);
    CHECK(outcome.switches.front() <= 12);
    CHECK(outcome.ran.back() == 3);
    CHECK(outcome.share(0, 200) >= 0.99);
    // Where twice was true.
    machine.bias.assign(6, 2.0);
    Steering dear(within(33.0));
    CHECK(drive(dear, machine, 100, 33.0, always, always).share(0, 100) == 1.0);
}

TEST_CASE("with nothing running there is nothing to leave, also where what ran was to be left at once", "[steering]") {
    Steering steering(within(33.0));
    const std::vector<Prediction> two{{0, 5.0, 0.2, 0.7}, {1, 20.0, 0.1, 0.7}};
    REQUIRE(steering.next(two)->prediction.candidate == 0);  // twice the other's time is over the budget
    for (int i = 0; i < 4; ++i) {
        steering.ran(0, 5.0, 5.0, 5.0);
        steering.next(two);
    }
    steering.fail(0);
    CHECK_FALSE(steering.mayLeave());
}

TEST_CASE("what models leave out grows with cost: one between two that have run is taken to lie between them", "[steering]") {
    const std::vector<Prediction> three{{0, 4.0, 0.4, 0.7}, {1, 8.0, 0.2, 0.7}, {2, 16.0, 0.1, 0.7}};
    SteeringOptions options = within(1000.0);
    options.groups = {0, 0, 0};
    Steering steering(options);
    const auto runs = [&](std::size_t candidate, double predicted, double took) {
        steering.resume(candidate);
        for (int i = 0; i < 12; ++i) steering.ran(candidate, predicted, took, took);
    };
    runs(0, 4.0, 4.0);
    runs(2, 16.0, 64.0);
    steering.fail(0);
    steering.fail(2);
    const auto step = steering.next(three);
    REQUIRE(step->prediction.candidate == 1);
    CHECK(step->expected == Approx(16.0));  // half way between 1 and 4 times, in logarithms
}

TEST_CASE("nothing fits: the quickest runs, is said to be over, and stays", "[steering]") {
    Machine machine;
    Steering steering(within(1.0));
    const Outcome outcome = drive(steering, machine, 300, 1.0, always, always);
    CHECK(outcome.switches.empty());
    CHECK(outcome.ran.back() == 0);
    // Two that are predicted to be about as quick: the quicker is found out, and then nothing swings.
    machine.milliseconds = {10, 10.5, 30};
    machine.error = {0.5, 0.5, 0.1};
    machine.bias = {2.0, 1.3, 1.0};
    Steering both(within(8.0));
    const Outcome found = drive(both, machine, 600, 8.0, always, always);
    CHECK(found.ran.back() == 1);
    CHECK(found.switches.size() <= 2);
    CHECK_FALSE(steering.next(machine.predict())->isWithinBudget);
}

TEST_CASE("what failed is not taken, also where nothing else is left; what broke the budget is", "[steering]") {
    Steering steering(within(20.0));
    const std::vector<Prediction> two{{0, 5.0, 0.2, 0.7}, {1, 8.0, 0.1, 0.7}};
    REQUIRE(steering.next(two)->prediction.candidate == 1);
    steering.fail(1);
    CHECK(steering.next(two)->prediction.candidate == 0);
    CHECK(steering.barred() == 1);
    steering.fail(0);
    CHECK_FALSE(steering.next(two));
    for (int i = 0; i < 120; ++i) steering.next(two);
    CHECK(steering.next(two));  // bars end

    Steering over(within(20.0));
    REQUIRE(over.next(two)->prediction.candidate == 1);
    for (int i = 0; i < 6; ++i) over.ran(1, 8.0, 40.0, 40.0);
    const auto step = over.next(two);
    CHECK(step->prediction.candidate == 0);
    CHECK(step->cause == SteeringCause::kOverBudget);
    CHECK(over.next({two[1]})->prediction.candidate == 1);  // barred, but all that the frame allows
}

TEST_CASE("a step that may not be taken yet is asked for again", "[steering]") {
    Steering steering(within(20.0));
    const std::vector<Prediction> two{{0, 5.0, 0.2, 0.7}, {1, 8.0, 0.1, 0.7}};
    REQUIRE(steering.next(two)->prediction.candidate == 1);
    for (int i = 0; i < 2; ++i) steering.ran(1, 8.0, 8.0, 8.0);
    CHECK_FALSE(steering.mayLeave());
    steering.ran(1, 8.0, 40.0, 40.0);
    CHECK(steering.mayLeave());
    steering.ran(1, 8.0, 40.0, 40.0);
    const auto kept = steering.next(two, false);
    CHECK(kept->prediction.candidate == 1);
    CHECK(kept->isLeaving);
    const auto left = steering.next(two, true);
    CHECK(left->prediction.candidate == 0);
    CHECK_FALSE(left->isLeaving);
}

TEST_CASE("times that are none leave predictions as they are", "[steering]") {
    Steering steering(within(20.0));
    const std::vector<Prediction> two{{0, 5.0, 0.2, 0.7}, {1, 8.0, 0.1, 0.7}};
    steering.next(two);
    for (const double none : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        for (int i = 0; i < 10; ++i) steering.ran(1, 8.0, none, none);
    CHECK(steering.load() == Approx(1.0));
    CHECK(steering.next(two)->expected == Approx(8.0));
}
