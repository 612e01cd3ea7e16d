#include "inputs/source_view.h"

#include "compute/error.h"
#include "inputs/image_access.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kMaxSide = 16384;

}  // namespace

std::string sourceViewName(std::uint32_t i) { return "frame.sourceViews[" + std::to_string(i) + "].gbuffer"; }

View sourceViewOf(const LWFrame& frame, std::uint32_t i) {
    const LWImage& image = frame.sourceViews[i].gbuffer->normal;
    if (imageAbsent(image) || image.width == 0 || image.height == 0 || image.width > kMaxSide || image.height > kMaxSide)
        fail(LW_ERROR_INVALID_ARGUMENT, sourceViewName(i), ".normal: expected an image of 1 .. ", kMaxSide, " pixels a side, got ",
             image.width, " x ", image.height);
    return View(image.width, image.height);
}

}  // namespace lightwell
