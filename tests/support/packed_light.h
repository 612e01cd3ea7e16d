// What tests ask of a picture as packed values, planes one after the other.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

namespace lightwell::test {

inline double meanOf(const std::vector<float>& values) {
    double sum = 0.0;
    for (const float v : values) sum += double(v);
    return sum / double(values.size());
}

// Root mean square by b's mean.
inline double difference(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(double(a[i]) - double(b[i]), 2.0);
    return std::sqrt(sum / double(a.size())) / meanOf(b);
}

// Of WallAndCeiling at this size, without the rows that show places above y = 1, and those that the filter mixes with them.
inline std::vector<float> inRoom(const std::vector<float>& values, std::uint32_t width, std::uint32_t height) {
    std::vector<float> kept;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (i / width % height >= height / 8) kept.push_back(values[i]);
    return kept;
}

}  // namespace lightwell::test
