// Renderers with a fault of a known kind and size: each passes frames of another one on and spoils them.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "indirect_renderer.h"
#include "noise_number.h"

namespace stability_test {

class PlantedFault : public cli::IndirectRenderer {
public:
    explicit PlantedFault(std::unique_ptr<cli::IndirectRenderer> sound) : sound_(std::move(sound)) {}

    cli::FrameSample renderFrame(const cli::RenderInputs& inputs, bool reset) override {
        cli::FrameSample sample = sound_->renderFrame(inputs, reset);
        const studio::PlanarBuffer& light = sound_->irradiance();
        studio::PlanarBuffer spoilt(light.width(), light.height(), light.planes());
        double sum = 0.0, count = 0.0;
        for (int plane = 0; plane < light.planes(); ++plane)
            for (int y = 0; y < light.height(); ++y)
                for (int x = 0; x < light.width(); ++x) {
                    sum += double(light.row(plane, y)[x]);
                    count += 1.0;
                }
        for (int plane = 0; plane < light.planes(); ++plane)
            for (int y = 0; y < light.height(); ++y)
                for (int x = 0; x < light.width(); ++x)
                    spoilt.row(plane, y)[x] =
                        spoil({frame_, plane, x, y, light.width(), light.height(), float(sum / count)},
                              light.row(plane, y)[x]);
        irradiance_ = std::move(spoilt);
        ++frame_;
        return sample;
    }
    const studio::PlanarBuffer& irradiance() const override { return irradiance_; }
    const studio::PlanarBuffer& validity() const override { return sound_->validity(); }
    std::uint64_t estimatedBytes() const override { return sound_->estimatedBytes(); }
    const LWDeviceInfo* device() const override { return sound_->device(); }
    cli::DebugPlanes readDebugView(const std::string& name) const override {
        return sound_->readDebugView(name);
    }

protected:
    struct Place {
        int frame, plane, x, y, width, height;
        float meanLight;  // of the sound frame
    };
    virtual float spoil(const Place& place, float light) = 0;
    // What was shown in the frame before.
    float shown(const Place& place) const { return irradiance_.row(place.plane, place.y)[place.x]; }

private:
    std::unique_ptr<cli::IndirectRenderer> sound_;
    studio::PlanarBuffer irradiance_;
    int frame_ = 0;
};

// Every pixel too bright or too dark by up to a share, anew in each frame.
class NoisyFault final : public PlantedFault {
public:
    NoisyFault(std::unique_ptr<cli::IndirectRenderer> sound, float share)
        : PlantedFault(std::move(sound)), share_(share) {}

private:
    float spoil(const Place& at, float light) override {
        return light * (1.0f + share_ * float(noiseNumber(3 * at.frame + at.plane, at.x, at.y)));
    }
    float share_;
};

// A history of the screen that nothing rejects: neither movement nor a reset.
class LaggingFault final : public PlantedFault {
public:
    LaggingFault(std::unique_ptr<cli::IndirectRenderer> sound, float newShare)
        : PlantedFault(std::move(sound)), newShare_(newShare) {}

private:
    float spoil(const Place& at, float light) override {
        return at.frame == 0 ? light : shown(at) + newShare_ * (light - shown(at));
    }
    float newShare_;
};

// A share of the picture's mean light everywhere, through all walls.
class LeakingFault final : public PlantedFault {
public:
    LeakingFault(std::unique_ptr<cli::IndirectRenderer> sound, float share)
        : PlantedFault(std::move(sound)), share_(share) {}

private:
    float spoil(const Place& at, float light) override { return light + share_ * at.meanLight; }
    float share_;
};

// More light with every frame.
class DriftingFault final : public PlantedFault {
public:
    DriftingFault(std::unique_ptr<cli::IndirectRenderer> sound, float sharePerFrame)
        : PlantedFault(std::move(sound)), share_(sharePerFrame) {}

private:
    float spoil(const Place& at, float light) override {
        return light * (1.0f + share_ * float(at.frame));
    }
    float share_;
};

// One frame with more light: times the mean light, in a disc of a radius in picture heights about the
// middle of the picture's lower half.
class FlashingFault final : public PlantedFault {
public:
    FlashingFault(std::unique_ptr<cli::IndirectRenderer> sound, int frame, float radius, float times)
        : PlantedFault(std::move(sound)), flash_(frame), radius_(radius), times_(times) {}

private:
    float spoil(const Place& at, float light) override {
        const float x = (float(at.x) + 0.5f - 0.5f * float(at.width)) / float(at.height);
        const float y = (float(at.y) + 0.5f) / float(at.height) - 0.75f;
        const bool isInside = at.frame == flash_ && std::hypot(x, y) < radius_;
        return isInside ? light + times_ * at.meanLight : light;
    }
    int flash_;
    float radius_, times_;
};

}  // namespace stability_test
