// A viewport as inputs, outputs and techniques know it.
#pragma once

#include <cstdint>

namespace lightwell {

// One viewport. Techniques keep their per-view buffers by view (PerView in techniques/technique.h).
class View {
public:
    View(std::uint32_t maxW, std::uint32_t maxH) : maxWidth(maxW), maxHeight(maxH), width(maxW), height(maxH) {}
    const std::uint32_t maxWidth, maxHeight;
    std::uint32_t width, height;
    const void* handle = nullptr;  // the API's name of it, as LWSourceView::view has it; null: none
};

}  // namespace lightwell
