// What every technique is to the API: a world part once per frame, a view part once per view.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "compute/error.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/frame_shape.h"
#include "inputs/view.h"
#include "lightwell/lightwell.h"

namespace lightwell {

class Device;

// An intermediate buffer as planes. One that has to be made of something else is described by planes without
// memory, and `fill` records the kernels that make it in the memory it gets for one read.
struct DebugView {
    const char* name;
    const char* description;
    Planes planes;
    std::function<void(Executor&, const Planes&)> fill;
};

// What lwRenderPoints is asked for: images of count x 1 pixels (harmonics: count x 4), those that are absent of LW_FORMAT_NONE.
struct Points {
    LWImage positions{}, normals{};
    std::uint32_t count = 0;
    LWPointOutput output{};
};

// Whether what earlier frames have left on the device can be built upon.
class Continuity {
public:
    explicit Continuity(Device& device);
    // Not in the next update(): a call broke off half-way.
    void lose() { isLost_ = true; }
    // Of an update() that will change things: whether all before it may be half made, be it that a call broke off or that
    // commands failed on the device.
    bool beginLost();

private:
    Device& device_;
    std::uint64_t failures_;  // that the device had seen when the last update began
    bool isLost_ = false;
};

class Technique {
public:
    virtual ~Technique() = default;

    // Record the frame's world part / one view's part. The API has checked handles, struct sizes and
    // that pointers are present where counts say so; inputs/ checks images; the technique checks the rest.
    virtual void update(Executor& executor, const LWFrame& frame) = 0;
    virtual void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer,
                        const LWOutput& output) = 0;
    // Of techniques whose entry says that they have light at points (LWTechniqueInfo::points); others are not asked.
    virtual void renderPoints(Executor&, const Points&) {
        fail(LW_ERROR_INTERNAL, "technique: expected one that has light at points, got another");
    }
    // Of techniques whose entry says that they have their light as lights (LWTechniqueInfo::lightList): how many at most, and what
    // makes them and has them copied to `lights`, which stays until the device has finished.
    virtual std::uint32_t listedLights() const { return 0; }
    virtual void readLightList(Executor&, LWListedLight*) {
        fail(LW_ERROR_INTERNAL, "technique: expected one that lists lights, got another");
    }
    // A call has broken off half-way, for want of memory or of the device: what is kept from frame to frame may be half made.
    virtual void lose() {}
    // Builds and launches every kernel that the parameters can need.
    virtual void prewarm(Executor& executor, const std::shared_ptr<View>& view) = 0;

    // Of the frames recorded so far. Waits for nothing: what the device knows is left to Report::read.
    virtual Report report() = 0;
    virtual std::vector<DebugView> debugViews(const View* view) = 0;  // a query: allocates and enqueues nothing
    virtual std::uint64_t bytes() const = 0;
};

struct TechniqueEntry {
    LWTechniqueInfo info;
    // `desc` has been checked against info.parameters.
    std::unique_ptr<Technique> (*create)(Device& device, const void* desc);
    // Of a technique that others are parts of: without those.
    std::uint64_t (*estimateBytes)(const void* desc, const LWViewDesc& view, const FrameShape& shape);
    // Instead of `create` where parameters are techniques (LW_PARAMETER_TECHNIQUE): those, in the parameters' order.
    std::unique_ptr<Technique> (*join)(Device& device, const std::vector<std::shared_ptr<Technique>>& techniques) = nullptr;
};
// The registry: one line per technique in registry.cpp.
const std::vector<TechniqueEntry>& techniqueEntries();
// Throws INVALID_ARGUMENT listing the valid names.
const TechniqueEntry& findTechniqueEntry(const char* name);

// Per-view state of a technique; dropped when the view is gone.
template <class State>
class PerView {
public:
    // The state of `view`, made by `make()` on first use.
    template <class Make>
    State& get(const std::shared_ptr<View>& view, Make make) {
        purge();
        for (auto& [key, state] : states_)
            if (key.lock() == view) return *state;
        states_.emplace_back(view, make());
        return *states_.back().second;
    }
    State* find(const View* view) {
        for (auto& [key, state] : states_)
            if (key.lock().get() == view && view) return state.get();
        return nullptr;
    }
    template <class Visit>
    void each(Visit visit) const {
        for (const auto& entry : states_) visit(*entry.second);
    }

    void clear() { states_.clear(); }

    // Drops the states of views that are gone.
    void purge() {
        for (std::size_t i = states_.size(); i-- > 0;)
            if (states_[i].first.expired()) states_.erase(states_.begin() + std::ptrdiff_t(i));
    }

private:
    std::vector<std::pair<std::weak_ptr<View>, std::unique_ptr<State>>> states_;
};

}  // namespace lightwell
