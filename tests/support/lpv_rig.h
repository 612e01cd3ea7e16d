// Grids of light propagation volumes in tests: from and to device memory.
#pragma once

#include <random>
#include <vector>

#include "passes/lpv_propagation.h"
#include "shared/lpv_types.h"
#include "support/kernel_rig.h"

namespace lightwell::test {

// A grid's cells without its borders: plane by plane, z, y, x.
struct LpvCells {
    int size;
    std::vector<float> values;
    explicit LpvCells(int n) : size(n), values(std::size_t(LW_LPV_PLANES) * std::size_t(n) * std::size_t(n) * std::size_t(n)) {}
    float& at(int plane, int x, int y, int z) { return values[std::size_t(((plane * size + z) * size + y) * size + x)]; }
    float at(int plane, int x, int y, int z) const { return values[std::size_t(((plane * size + z) * size + y) * size + x)]; }
    double sum(int plane) const {
        double total = 0.0;
        const std::size_t cells = values.size() / LW_LPV_PLANES;
        for (std::size_t i = 0; i < cells; ++i) total += double(values[std::size_t(plane) * cells + i]);
        return total;
    }

    // In the grid's own layout, borders 0.
    std::vector<float> laidOut() const {
        std::vector<float> grid(LpvPropagation::gridBytes(std::uint32_t(size)) / sizeof(float));
        visit([&](int p, int x, int y, int z) { grid[place(p, x, y, z)] = at(p, x, y, z); });
        return grid;
    }
    static LpvCells of(const Buffer& buffer, int size) {
        std::vector<float> grid(LpvPropagation::gridBytes(std::uint32_t(size)) / sizeof(float));
        buffer.download(0, grid.size() * sizeof(float), grid.data());
        LpvCells cells(size);
        cells.visit([&](int p, int x, int y, int z) { cells.at(p, x, y, z) = grid[cells.place(p, x, y, z)]; });
        return cells;
    }
    template <class Visit>
    void visit(Visit visit) const {
        for (int p = 0; p < LW_LPV_PLANES; ++p)
            for (int z = 0; z < size; ++z)
                for (int y = 0; y < size; ++y)
                    for (int x = 0; x < size; ++x) visit(p, x, y, z);
    }
    std::size_t place(int plane, int x, int y, int z) const {
        return std::size_t(plane * lpv_plane(size) + lpv_cell(size, x, y, z));
    }
};

// Random light in all cells that are at least `margin` from the border.
inline LpvCells randomLight(int size, int margin) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    LpvCells cells(size);
    cells.visit([&](int p, int x, int y, int z) {
        const auto inside = [&](int i) { return i >= margin && i < size - margin; };
        if (inside(x) && inside(y) && inside(z)) cells.at(p, x, y, z) = unit(random) + (p % LW_LPV_BANDS ? 0.0f : 1.5f);
    });
    return cells;
}

}  // namespace lightwell::test
