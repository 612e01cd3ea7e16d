// The sizes of a frame's inputs, for estimates of memory.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace lightwell {

// What a technique's memory depends on in a frame.
struct FrameShape {
    std::uint64_t texels = 0;        // of all RSMs
    std::uint64_t paddedTexels = 0;  // the same with rows rounded up to 16
    std::uint64_t rows = 0;          // of all RSMs
    std::uint64_t maps = 0;          // RSMs
    std::uint64_t largestMap = 0;    // texels of the largest RSM
    std::uint32_t vplCount = 0;      // the host's own VPLs
    std::uint32_t staticVplCount = 0, lightCount = 0, blockerCount = 0;
    std::uint32_t aimedSpots = 0;       // spot lights of which something says where their axis meets the scene
    std::uint32_t aimedBySpotMaps = 0;  // of these, those of which a map says it
    std::uint32_t profileValues = 0;    // of all lights' profiles
    bool bakedReceivers = false;        // some lights or static VPLs are not for all receivers
    std::uint32_t triangles = 0;     // of the host's geometry
    std::uint32_t surfels = 0;       // of the host's geometry
    std::uint64_t sourcePixels = 0;  // of all source views, rows rounded up to 16
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sources;  // width and height of each source view
    bool uploads = false;            // host memory goes through copies on the device (no unified memory)
    void addMap(std::uint64_t width, std::uint64_t height) {
        texels += width * height;
        paddedTexels += (width + 15) / 16 * 16 * height;
        rows += height;
        ++maps;
        if (width * height > largestMap) largestMap = width * height;
    }
};

}  // namespace lightwell
