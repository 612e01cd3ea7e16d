// The traced pixels of a tile, taken out of the G-buffer once for all of their paths.
#pragma once

#include <cstdint>
#include <vector>

#include "gbuffer.h"
#include "rival_filter.h"
#include "rival_paths.h"

namespace studio {

// Where the traced pixels lie: one for each block of factor x factor pixels of the picture.
struct TracedGrid {
    int factor = 1, width = 0, height = 0;
};

struct TilePixels {
    static constexpr int kSize = PathBatch::kSize;
    int count = 0;                                                           // of those with a surface
    alignas(64) float position[3][kSize], face[3][kSize], normal[3][kSize];  // position: off the surface
    alignas(64) std::uint32_t index[kSize];
    alignas(64) std::int32_t target[kSize];

    // Pixels of the tile in `order` (offsets from left, top). target: y * side + x in the tile. index:
    // of the pixel in the pattern of n x n, or of the picture for n = 0. coarse*: planes to fill with
    // the surfaces of the traced pixels, or null.
    void take(const RayScene& scene, const GBuffer& view, const TracedGrid& grid, int left, int top,
              int side, int n, const std::vector<PixelPlace>& order, TracedSurfaces& surfaces);
    // Pixels of the picture, in any places; target: their number in the list.
    void take(const RayScene& scene, const GBuffer& view, const PixelPlace* pixels, int pixelCount);
    // Paths with the sample points index * perPixel + sample; their targets are shifted.
    void addTo(PathBatch& batch, std::uint32_t perPixel, std::uint32_t sample,
               std::int32_t targetShift) const;

private:
    struct Rows {  // as they lie in the picture
        alignas(64) float position[3][kSize], face[3][kSize], normal[3][kSize];
        alignas(64) float origin[3][kSize];  // off the surface
    };
    static void readRow(const GBuffer& view, const TracedGrid& grid, int left, int count, int y,
                        float floor, Rows& to, int at);
    static void repair(const RayScene& scene, const GBuffer& view, const TracedGrid& grid, int x, int y,
                       Rows& to, int at);
    void keep(const Rows& rows, int from, std::uint32_t pixelIndex, std::int32_t pixelTarget);
};

}  // namespace studio
