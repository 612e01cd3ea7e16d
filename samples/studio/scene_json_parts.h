// Parts of the scene JSON reader: keyframes, cameras and lights. Internal to scene_json*.cpp.
#pragma once

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "json_reader.h"
#include "scene.h"

namespace studio {

constexpr float kDegrees = kPi / 180.0f;
constexpr float kAny = 3.402823466e38f;

// Times of a list of keys must rise.
template <class T, class Read>
std::vector<std::pair<float, T>> readKeys(const JsonValue& value, Read read) {
    std::vector<std::pair<float, T>> keys;
    for (const JsonValue& item : value.list()) {
        JsonObject o = item.object();
        const JsonValue at = o.need("time", "the key's time in seconds");
        const float time = at.number();
        if (!keys.empty() && time <= keys.back().first)
            at.fail(fmt::format("a time after the key before, {}", keys.back().first));
        keys.emplace_back(time, read(o));
        o.finish();
    }
    if (keys.empty()) value.fail("at least one key");
    return keys;
}

// Append a camera or light with its keyframes.
void readJsonCamera(const JsonValue& value, Scene& scene);
void readJsonLight(const JsonValue& value, Scene& scene);

}  // namespace studio
