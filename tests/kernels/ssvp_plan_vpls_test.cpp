// How many VPLs a frame takes: of five lit texels, even light, spots.
#include "passes/ssvp_plan.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "support/ssvp_plan_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

// An RSM of `side`^2 texels on a floor of one metre, with this flux.
class LitTexels {
public:
    LitTexels(KernelRig& rig, std::uint32_t side, const std::function<double(double, double)>& flux)
        : planes_(rig.upload(planesOf(side, flux))), rows_(rig.upload(rowsOf(side))) {
        input.texels.memory = planes_.get();
        input.texels.rowStride = input.texels.planeStride = input.texels.width =
            paddedWidth(side) * side;
        input.texels.height = 1;
        input.texels.count = RsmInput::kPlaneCount;
        input.rows = Buffer::retained(rig.device(), rows_.get());
        input.rowCount = side;
        input.texelCount = side * side;
    }
    RsmInput input;

private:
    static std::vector<float> planesOf(std::uint32_t side,
                                       const std::function<double(double, double)>& flux) {
        const std::size_t row = paddedWidth(side), count = row * side;
        std::vector<float> planes(count * RsmInput::kPlaneCount, 0.0f);
        for (std::size_t y = 0; y < side; ++y)
            for (std::size_t x = 0; x < side; ++x) {
                const std::size_t t = y * row + x;
                const double u = (double(x) + 0.5) / side, v = (double(y) + 0.5) / side;
                planes[std::size_t(RsmInput::kPositionX) * count + t] = float(u);
                planes[(std::size_t(RsmInput::kPositionX) + 2) * count + t] = float(v);
                planes[std::size_t(RsmInput::kNormalY) * count + t] = 1.0f;
                for (std::size_t c = 0; c < 3; ++c)
                    planes[(std::size_t(RsmInput::kFluxR) + c) * count + t] = float(flux(u, v));
                planes[std::size_t(RsmInput::kArea) * count + t] = 1.0f / float(side * side);
            }
        return planes;
    }
    static std::vector<cl_int4> rowsOf(std::uint32_t side) {
        std::vector<cl_int4> rows;
        for (std::uint32_t y = 0; y < side; ++y)
            rows.push_back({{cl_int(y * paddedWidth(side)), cl_int(side), 0, 0}});
        return rows;
    }
    Guarded planes_, rows_;
};

Used drawFrame(KernelRig& rig, SsvpPlan& plan, VplSampling& sampling, const RsmInput& input,
               bool restart = false) {
    plan.begin(rig.executor(), restart);
    const VplPlan choice{plan.live(), [&](const Buffer& texelSums, const Buffer& rowTotals) {
                             plan.recordVpls(rig.executor(), input, texelSums, rowTotals);
                         }};
    sampling.record(rig.executor(), input, nullptr, 0, &choice);
    return usedBy(rig, plan);
}

double fluxOf(const VplSampling& sampling, std::uint32_t* lit) {
    std::vector<lw_vpl> vpls(std::size_t(sampling.order().subsets * sampling.order().capacity));
    sampling.vpls().download(0, vpls.size() * sizeof(lw_vpl), vpls.data());
    double sum = 0.0;
    *lit = 0;
    for (const lw_vpl& vpl : vpls) {
        sum += double(vpl.flux.s[0]);
        *lit += vpl.flux.s[0] > 0.0f;
    }
    return sum;
}

double fiveTexels(double u, double v) {  // of 32 x 32
    const int x = int(u * 32.0), y = int(v * 32.0);
    return (x == 3 && (y == 4 || y == 20)) || (x == 17 && (y == 4 || y == 9)) || (x == 30 && y == 30)
               ? 2e-4
               : 0.0;
}

}  // namespace

TEST_CASE("five lit texels take VPLs for five, an even light what the target asks for", "[ssvp_plan]") {
    KernelRig rig(GENERATE(1u, 16u));
    const float error = 0.3f;
    const double share = double(error) / std::sqrt(3.0);
    const LitTexels five(rig, 32, fiveTexels), even(rig, 32, [](double, double) { return 1e-3; });
    SsvpPlan plan(rig.device(), optionsOf(error));
    VplSamplingOptions sampled;
    sampled.subsets = 1;
    VplSampling sampling(rig.device(), sampled);
    const Used first = drawFrame(rig, plan, sampling, five.input);
    CHECK(first.vpls == 256);
    CHECK(first.whyVpls.find("first frame") != std::string::npos);
    const Used used = drawFrame(rig, plan, sampling, five.input);
    const double needed =
        1.5 * std::sqrt(5.0) / share;  // fewer than 5 times as many as there are texels
    CHECK(used.vpls >= std::uint32_t(std::ceil(needed)));
    CHECK(used.vpls <= std::uint32_t(1.2 * (needed + 1.0)) + 1);
    CHECK(used.vpls < 25);
    CHECK(used.whyVpls.find("few texels") != std::string::npos);
    std::uint32_t lit = 0;
    CHECK(fluxOf(sampling, &lit) == Approx(5.0 * 2e-4).epsilon(1e-5));
    CHECK(lit == used.vpls);
    const Used spread = drawFrame(rig, plan, sampling, even.input);
    CHECK(spread.vpls > used.vpls);
    CHECK(double(spread.vpls) >= std::floor(1.5 * 1.5 / (share * share)));
    CHECK(fluxOf(sampling, &lit) == Approx(1024.0 * 1e-3).epsilon(1e-5));
    const Used cut = drawFrame(rig, plan, sampling, even.input, true);
    CHECK(cut.vpls == 256);
}

TEST_CASE("half the error never takes fewer VPLs; still light keeps its count, a slow sweep too",
          "[ssvp_plan]") {
    KernelRig rig(16);
    VplSamplingOptions sampled;
    sampled.subsets = 1;
    VplSampling sampling(rig.device(), sampled);
    std::uint32_t last = 256;
    for (const float error : targets()) {
        const LitTexels light(
            rig, 32, [](double u, double v) { return 1e-3 * std::exp(-20.0 * (u * u + v * v)); });
        SsvpPlan plan(rig.device(), optionsOf(error));
        drawFrame(rig, plan, sampling, light.input);
        const std::uint32_t count = drawFrame(rig, plan, sampling, light.input).vpls;
        CHECK(count <= last);
        for (int i = 0; i < someFrames(5, 1); ++i)
            CHECK(drawFrame(rig, plan, sampling, light.input).vpls == count);
        last = count;
    }
    CHECK(last < 256);
    // A spot that grows from 0.1 to 0.3 of the map: its texels, and so their root, grow ninefold and
    // threefold.
    SsvpPlan plan(rig.device(), optionsOf(0.2f));
    int changes = 0;
    const int steps = someFrames(60, 3);
    for (int i = 0; i <= steps; ++i) {
        const double radius = 0.1 + 0.2 * i / steps;
        const LitTexels spot(rig, 32, [&](double u, double v) {
            return std::hypot(u - 0.5, v - 0.5) < radius ? 1e-3 : 0.0;
        });
        const std::uint32_t count = drawFrame(rig, plan, sampling, spot.input).vpls;
        if (i > 1) changes += count != last;
        last = count;
    }
    CHECK(changes <= 6);  // each by a fifth or more
}
