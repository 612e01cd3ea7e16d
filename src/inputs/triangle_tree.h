// The tree of boxes over triangles that rays go through: shared/geometry_types.h.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace lightwell {

struct TriangleBox {
    float lower[3], upper[3];  // m
};

struct TriangleTree {
    std::vector<std::uint32_t> order;  // of the triangles by leaves
    std::vector<float> nodes;          // LW_TREE_NODE floats each, the root first
};

// A strict order of the triangles by their own values.
using TriangleOrder = std::function<bool(std::uint32_t, std::uint32_t)>;

// By what triangles are, not by where they stand among the others: leaves in that order, whatever the order of `boxes`.
TriangleTree triangleTreeOf(const std::vector<TriangleBox>& boxes, const TriangleOrder& isBefore);

// One node, without any below it, whose boxes hold all of these: no more than what a tree's root has.
std::vector<float> boxesAround(const std::vector<TriangleBox>& boxes);

// The most nodes over so many triangles.
std::uint64_t mostTreeNodes(std::uint64_t triangles);

}  // namespace lightwell
