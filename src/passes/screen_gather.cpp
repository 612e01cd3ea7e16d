#include "passes/screen_gather.h"

#include <string>

#include "compute/device.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "screen_gather/screen_gather";
// A pass of its own for each level, counted from the start: what a level costs is worth knowing (Soler et al., fig. 7).
constexpr const char* kLevelPasses[] = {"screen_gather.level1", "screen_gather.level2", "screen_gather.level3",
                                        "screen_gather.level4", "screen_gather.level5", "screen_gather.level6"};

Defines definesOf(std::uint32_t interleave, bool planned = false) {
    Defines defines{{"LW_INTERLEAVE", std::to_string(interleave)}};
    if (planned) defines.push_back({"LW_PLANNED", "1"});
    return defines;
}

Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

std::uint32_t perItem(std::uint32_t count, std::uint32_t each) { return (count + each - 1) / each; }

std::uint64_t layOutDealt(std::uint32_t width, std::uint32_t height, LevelRange range, std::uint32_t interleave,
                          std::vector<cl_int4>* layouts) {
    std::uint64_t at = 0;
    for (std::uint32_t k = range.first; k <= range.last; ++k) {
        const std::uint32_t segment = paddedWidth(perItem(levelSize(width, k), interleave)) + LW_PYRAMID_BORDER;
        const std::uint32_t row = interleave * segment + LW_PYRAMID_BORDER;
        const std::uint64_t plane = std::uint64_t(row) * levelSize(height, k);
        if (layouts) layouts->push_back({{cl_int(at + LW_PYRAMID_BORDER), cl_int(row), cl_int(plane), cl_int(segment)}});
        at += plane * LW_SENDER_PLANES;
    }
    return at;
}

std::uint64_t layOutLight(std::uint32_t width, std::uint32_t height, LevelRange range, std::uint32_t interleave,
                          std::vector<Planes>* levels) {
    // A work-item of the gather writes every interleave-th column of 16 * interleave.
    return layOutLevels(width, height, range, LW_LIGHT_PLANES, 16 * interleave, LW_PYRAMID_BORDER, levels);
}

}  // namespace

ScreenLevels::ScreenLevels(Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight, LevelRange range,
                           std::uint32_t interleave)
    : range_(range),
      interleave_(interleave),
      dealt_(device, std::size_t(layOutDealt(maxWidth, maxHeight, range, interleave, nullptr)) * sizeof(float),
             "senders of a view's levels") {
    for (Buffer& memory : lightMemory_)
        memory = Buffer(device, std::size_t(layOutLight(maxWidth, maxHeight, range, interleave, nullptr)) * sizeof(float),
                        "light of a view's levels");
}

std::uint64_t ScreenLevels::estimateBytes(std::uint32_t maxWidth, std::uint32_t maxHeight, LevelRange range,
                                          std::uint32_t interleave) {
    return (layOutDealt(maxWidth, maxHeight, range, interleave, nullptr) +
            2 * layOutLight(maxWidth, maxHeight, range, interleave, nullptr)) * sizeof(float);
}

void ScreenLevels::resize(Executor& executor, std::uint32_t width, std::uint32_t height) {
    if (width == width_ && height == height_) return;
    dealtLayouts_.clear();
    layOutDealt(width, height, range_, interleave_, &dealtLayouts_);
    std::vector<Planes>* const light[2] = {&own_, &other_};
    for (int i = 0; i < 2; ++i) {
        light[i]->clear();
        layOutLight(width, height, range_, interleave_, light[i]);
        for (Planes& planes : *light[i]) planes.memory = lightMemory_[i].get();
        executor.fill("screen_gather.clear", lightMemory_[i], 0, 0, lightMemory_[i].bytes());
    }
    executor.fill("screen_gather.clear", dealt_, 0, 0, dealt_.bytes());
    width_ = width;
    height_ = height;
}

ScreenGather::ScreenGather(Device& device, std::uint32_t interleave, bool planned)
    : interleave_(interleave),
      deal_(device.programs().kernel(kProgram, "screen_gather_deal", definesOf(interleave, planned))),
      gather_(device.programs().kernel(kProgram, "screen_gather_gather", definesOf(interleave, planned))) {}

void ScreenGather::recordDeal(Executor& executor, const PyramidLevels& pyramid, const ScreenLevels& levels, std::uint32_t k,
                              const Buffer* plan) {
    const Planes level = pyramid.level(k);
    const auto run = [&](const auto&... more) {
        executor.run("screen_gather.deal", deal_, {perItem(level.width, deal_.width() * interleave_), level.height}, groupOf(deal_),
                     level, cl_int(level.width), cl_int(level.height), levels.dealt(), levels.dealtLayout(k), more...);
    };
    if (plan)
        run(*plan, cl_int(k - levels.range().first));
    else
        run();
}

template <typename... More>
void ScreenGather::runGather(Executor& executor, const ScreenLevels& levels, std::uint32_t k, const Buffer& samples,
                             std::uint32_t sampleCount, bool bounded, const Planes& light, const More&... more) {
    constexpr float kBound = 0.25f / 3.14159265f;
    const std::uint32_t vectors = perItem(perItem(light.width, interleave_), gather_.width());
    executor.run(kLevelPasses[k - levels.range().first], gather_, {std::size_t(vectors) * interleave_, light.height}, groupOf(gather_),
                 levels.dealt(), levels.dealtLayout(k), cl_int(light.width), cl_int(light.height), samples, cl_int(sampleCount),
                 bounded ? kBound : 0.0f, light, more...);
}

void ScreenGather::recordGather(Executor& executor, const ScreenLevels& levels, std::uint32_t k, const Buffer& samples,
                                std::uint32_t sampleCount, bool bounded, const Planes& light) {
    runGather(executor, levels, k, samples, sampleCount, bounded, light);
}

void ScreenGather::recordGather(Executor& executor, const ScreenLevels& levels, std::uint32_t k, const Buffer& samples,
                                const Buffer& discs, std::uint32_t sampleCount, bool bounded, const Planes& light, const Buffer& plan) {
    runGather(executor, levels, k, samples, sampleCount, bounded, light, discs, plan, cl_int(k - levels.range().first));
}

}  // namespace lightwell
