// The parameters of a temporal history, the same in every technique that has one.
#pragma once

#include <cstddef>

#include "passes/temporal_history.h"
#include "techniques/parameter_table.h"

namespace lightwell {

inline LWParameter historyParameter(std::size_t byteOffset, std::uint32_t frames = 0) {
    return parameter("history", "frames that a pixel's light is a mean over, at most, each with other samples: less noise and flicker, memory, light that changes arrives later; 0: each frame alone",
                     LW_PARAMETER_UINT, byteOffset, 0, TemporalHistoryOptions::kMostFrames, frames);
}

inline LWParameter historyClampParameter(std::size_t byteOffset) {
    return parameter("history_clamp", "how far a history may lie from its frame's light, in deviations of that light: noise falls and ghosts grow with it; 0: any",
                     LW_PARAMETER_FLOAT, byteOffset, 0, 100, TemporalHistoryOptions{}.clamp);
}

}  // namespace lightwell
