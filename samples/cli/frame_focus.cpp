#include "frame_focus.h"

#include <fmt/format.h>

#include <cmath>

#include "cli.h"

namespace cli {
namespace {

constexpr double kFarthest = 1e9;  // as positions, lightwell.h

float coordinate(const std::string& option, const std::string& text) {
    const double value = parseNumber(option, text);
    if (std::abs(value) > kFarthest)
        throw UsageError(
            fmt::format("{} '{}': expected a coordinate within {:g}", option, text, kFarthest));
    return float(value);
}

}  // namespace

FrameFocus parseFocus(const std::string& option, const std::string& text) {
    if (text == "eye") return {};
    if (text == "none") return {FrameFocus::Kind::None, {}};
    const std::size_t first = text.find(','), second = text.find(',', first + 1);
    if (first == std::string::npos || second == std::string::npos)
        throw UsageError(fmt::format("{} '{}': expected eye, none, or a point X,Y,Z", option, text));
    return {FrameFocus::Kind::Point,
            {coordinate(option, text.substr(0, first)),
             coordinate(option, text.substr(first + 1, second - first - 1)),
             coordinate(option, text.substr(second + 1))}};
}

}  // namespace cli
