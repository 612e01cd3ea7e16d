// A sequence of the catalogue with its truth and everything that techniques get of it, for tests that
// render it several times.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "indirect_renderer.h"
#include "lit_points.h"
#include "path_tracer.h"
#include "sequence.h"
#include "stability_indices.h"

namespace stability_test {

class SequenceRig {
public:
    // Truths of one bounce: two of `samples` paths per pixel each, from independent sample points.
    SequenceRig(const std::string& name, const studio::SequenceSize& size, int samples)
        : sequence_(studio::makeSequence(name, size)) {
        const studio::SequenceFrame& middle = sequence_.frames[sequence_.frames.size() / 2];
        const studio::RayScene middleScene(middle.scene, middle.time);
        const std::unique_ptr<studio::LitPoints> guide = studio::makeGuide(
            middleScene, studio::renderGBuffer(middleScene, middle.camera, middle.width, middle.height,
                                               middle.camera, middle.time));
        studio::SeenFrame seenBefore;
        for (std::size_t f = 0; f < sequence_.frames.size(); ++f) {
            const studio::SequenceFrame& frame = sequence_.frames[f];
            scenes_.push_back(std::make_unique<studio::RayScene>(frame.scene, frame.time));
            const studio::SequenceFrame* before = f == 0 ? nullptr : &sequence_.frames[f - 1];
            addInputs(frame, before);
            studio::SeenFrame seen = studio::seeFrame(*scenes_.back(), frame);
            addFrame(frame, before, seen, seenBefore);
            addTruth(*guide, samples);
            seenBefore = std::move(seen);
        }
    }
    const cli::RenderInputs& firstInputs() const { return *inputs_.front(); }

    studio::StabilityIndices judge(cli::IndirectRenderer& renderer) const {
        std::vector<studio::StabilityFrame> frames = frames_;
        for (std::size_t f = 0; f < frames.size(); ++f) {
            renderer.renderFrame(*inputs_[f], sequence_.frames[f].reset);
            frames[f].image = packed(renderer.irradiance());
            frames[f].truth = first_[f];
            for (std::size_t i = 0; i < frames[f].truth.size(); ++i)
                frames[f].truth[i] = 0.5f * (first_[f][i] + second_[f][i]);
        }
        return studio::stabilityIndices(frames);
    }
    // What one truth reads against the other.
    studio::StabilityIndices floors() const {
        std::vector<studio::StabilityFrame> frames = frames_;
        for (std::size_t f = 0; f < frames.size(); ++f) {
            frames[f].image = first_[f];
            frames[f].truth = second_[f];
        }
        return studio::stabilityIndices(frames);
    }

private:
    static std::vector<float> packed(const studio::PlanarBuffer& buffer) {
        std::vector<float> values;
        for (int plane = 0; plane < buffer.planes(); ++plane)
            for (int y = 0; y < buffer.height(); ++y)
                values.insert(values.end(), buffer.row(plane, y), buffer.row(plane, y) + buffer.width());
        return values;
    }
    void addInputs(const studio::SequenceFrame& frame, const studio::SequenceFrame* before) {
        cli::InputOptions options;
        options.width = frame.width;
        options.height = frame.height;
        options.time = frame.time;
        options.rsm.size = 128;
        if (before != nullptr && !frame.isCut) {
            options.previousCamera = &before->camera;
            options.previousTime = before->time;
        }
        inputs_.push_back(std::make_unique<cli::RenderInputs>(*scenes_.back(), frame.camera, options));
    }
    void addFrame(const studio::SequenceFrame& frame, const studio::SequenceFrame* before,
                  const studio::SeenFrame& seen, const studio::SeenFrame& seenBefore) {
        studio::StabilityFrame judged;
        judged.width = frame.width;
        judged.height = frame.height;
        judged.surface = seen.surface;
        judged.isCut = frame.isCut;
        if (before != nullptr)
            judged.previous = studio::previousPositions(*scenes_.back(), frame, *before, seenBefore);
        else
            judged.previous.assign(seen.surface.size(),
                                   glm::vec2(std::numeric_limits<float>::quiet_NaN()));
        if (sequence_.region)
            for (std::size_t i = 0; i < seen.surface.size(); ++i)
                judged.region.push_back(seen.surface[i] != 0 ? sequence_.region(frame, seen.position[i])
                                                             : 0);
        frames_.push_back(std::move(judged));
    }
    void addTruth(const studio::LitPoints& guide, int samples) {
        studio::PathTracerOptions options;
        options.samplesPerPixel = 2 * samples;  // of both halves
        options.maxBounces = 1;
        options.commonPoints = true;
        options.guide = &guide;
        const studio::Image image =
            studio::tracePaths(*scenes_.back(), inputs_.back()->gbuffer(), options);
        for (const auto& [half, planes] :
             {std::pair{"a.bounce1.", &first_}, std::pair{"b.bounce1.", &second_}}) {
            planes->emplace_back();
            for (const char* channel : {"R", "G", "B"}) {
                const std::vector<float>& plane = image.plane(half + std::string(channel));
                planes->back().insert(planes->back().end(), plane.begin(), plane.end());
            }
        }
    }

    studio::FailureSequence sequence_;
    std::vector<std::unique_ptr<studio::RayScene>> scenes_;
    std::vector<std::unique_ptr<cli::RenderInputs>> inputs_;
    std::vector<studio::StabilityFrame> frames_;  // without images
    std::vector<std::vector<float>> first_, second_;
};

}  // namespace stability_test
