// What a frame tells grids to lie around that do not hold all of the scene (LWFrame::focus).
#pragma once

#include <string>

#include <glm/vec3.hpp>

namespace cli {

struct FrameFocus {
    enum class Kind { Eye, None, Point };
    Kind kind = Kind::Eye;
    glm::vec3 point{0.0f};
};

// "eye", "none" or "X,Y,Z"; UsageError naming the option.
FrameFocus parseFocus(const std::string& option, const std::string& text);

}  // namespace cli
