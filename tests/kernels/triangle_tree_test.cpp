// The tree of boxes over triangles: what it holds and where, its depth and its size, for even and for crooked scenes.
#include "inputs/triangle_tree.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

#include "shared/geometry_types.h"

using namespace lightwell;

namespace {

struct Walk {
    std::vector<int> seen;  // of each place in the order
    std::size_t nodes = 0, depth = 0, loose = 0, fullest = 0;
};

std::int32_t wordAt(const TriangleTree& tree, std::size_t node, std::size_t word) {
    std::int32_t value;
    std::memcpy(&value, &tree.nodes[node * LW_TREE_NODE + word], sizeof value);
    return value;
}

bool holds(const TriangleTree& tree, std::size_t node, std::size_t child, const TriangleBox& box) {
    for (std::size_t c = 0; c < 3; ++c) {
        const double centre = double(tree.nodes[node * LW_TREE_NODE + 16 * c + child]),
                     half = double(tree.nodes[node * LW_TREE_NODE + LW_TREE_HALF + 16 * c + child]);
        if (!(centre - half < double(box.lower[c]) && centre + half > double(box.upper[c]))) return false;
    }
    return true;
}

// All triangles under a node; counts those that one of their boxes does not hold.
std::vector<std::size_t> walk(const TriangleTree& tree, const std::vector<TriangleBox>& boxes, std::size_t node, std::size_t depth,
                              Walk& result) {
    ++result.nodes;
    result.depth = std::max(result.depth, depth);
    std::vector<std::size_t> all;
    for (std::size_t child = 0; child < LW_TREE_CHILDREN; ++child) {
        if (tree.nodes[node * LW_TREE_NODE + LW_TREE_HALF + child] < 0.0f) continue;
        const auto at = std::size_t(wordAt(tree, node, LW_TREE_CHILD + child)), count = std::size_t(wordAt(tree, node, LW_TREE_COUNT + child));
        std::vector<std::size_t> under(count);
        std::iota(under.begin(), under.end(), at);
        for (const std::size_t place : under) ++result.seen[place];
        result.fullest = std::max(result.fullest, count);
        if (count == 0) under = walk(tree, boxes, at, depth + 1, result);
        for (const std::size_t place : under)
            if (!holds(tree, node, child, boxes[tree.order[place]])) ++result.loose;
        all.insert(all.end(), under.begin(), under.end());
    }
    return all;
}

// By the boxes alone: enough where no two are alike.
TriangleTree treeOf(const std::vector<TriangleBox>& boxes) {
    return triangleTreeOf(boxes, [&](std::uint32_t a, std::uint32_t b) { return std::memcmp(&boxes[a], &boxes[b], sizeof boxes[a]) < 0; });
}

void checkTree(const std::vector<TriangleBox>& boxes) {
    const TriangleTree tree = treeOf(boxes);
    CAPTURE(boxes.size());
    Walk result;
    result.seen.resize(boxes.size());
    REQUIRE(tree.order.size() == boxes.size());
    walk(tree, boxes, 0, 1, result);
    CHECK(std::all_of(result.seen.begin(), result.seen.end(), [](int times) { return times == 1; }));
    CHECK(result.nodes * LW_TREE_NODE == tree.nodes.size());
    CHECK(result.nodes <= mostTreeNodes(boxes.size()));
    CHECK(result.depth <= LW_TREE_LEVELS);
    CHECK(result.fullest <= LW_TRIANGLE_GROUP);
    CHECK(result.loose == 0);
    std::vector<std::uint32_t> sorted = tree.order;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 0; i < sorted.size(); ++i) REQUIRE(sorted[i] == i);
}

std::vector<TriangleBox> someBoxes(std::size_t count, float offset = 0.0f) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<TriangleBox> boxes(count);
    for (TriangleBox& box : boxes)
        for (std::size_t c = 0; c < 3; ++c) {
            box.lower[c] = offset + 20.0f * unit(random);
            box.upper[c] = box.lower[c] + 4.0f * std::pow(unit(random), 8.0f);
        }
    return boxes;
}

}  // namespace

TEST_CASE("every triangle stands in one leaf, and every box above holds it", "[triangle_tree]") {
    for (const std::size_t count : {1u, 4u, 16u, 17u, 21u, 256u, 257u, 5000u, 60000u}) checkTree(someBoxes(count));
    checkTree(someBoxes(3000, 1e5f));  // far from the origin, where coordinates are coarse
    CHECK(treeOf({}).nodes.empty());
    CHECK(mostTreeNodes(0) == 0);
}

TEST_CASE("scenes that no plane splits well make no deeper tree than kernels can hold", "[triangle_tree]") {
    checkTree(std::vector<TriangleBox>(40000, TriangleBox{{1, 2, 3}, {2, 3, 4}}));  // all alike
    // Each twice as far as the one before, and again from the start: splits by bins peel off a few at a time.
    std::vector<TriangleBox> boxes;
    for (int i = 0; i < 20000; ++i) {
        const float at = std::ldexp(1.0f + float(i) * 1e-6f, -(i % 100));
        boxes.push_back({{at, 0.0f, 0.0f}, {at, 1.0f, float(i) * 1e-9f}});
    }
    checkTree(boxes);
    std::vector<TriangleBox> dust;  // bins so narrow that how many go into a metre is no float
    for (int i = 0; i < 100; ++i) dust.push_back({{float(i) * 1e-42f, 0.0f, 0.0f}, {float(i) * 1e-42f, 1.0f, 1.0f}});
    checkTree(dust);
}

TEST_CASE("a node alone holds all boxes, apart where they are", "[triangle_tree]") {
    for (const std::size_t count : {0u, 1u, 17u, 5000u}) {
        const std::vector<TriangleBox> boxes = someBoxes(count);
        TriangleTree root;
        root.nodes = boxesAround(boxes);
        REQUIRE(root.nodes.size() == LW_TREE_NODE);
        for (const TriangleBox& box : boxes) {
            bool isHeld = false;
            for (std::size_t child = 0; child < LW_TREE_CHILDREN; ++child) isHeld = isHeld || holds(root, 0, child, box);
            REQUIRE(isHeld);
        }
    }
}

TEST_CASE("the tree is the same whatever the order of the triangles", "[triangle_tree]") {
    const std::vector<TriangleBox> boxes = someBoxes(3000);
    std::vector<TriangleBox> shuffled = boxes;
    std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(9));
    const TriangleTree tree = treeOf(boxes), again = treeOf(shuffled);
    REQUIRE(tree.nodes.size() == again.nodes.size());
    CHECK(std::memcmp(tree.nodes.data(), again.nodes.data(), tree.nodes.size() * sizeof(float)) == 0);
    for (std::size_t i = 0; i < boxes.size(); ++i)
        REQUIRE(std::memcmp(&boxes[tree.order[i]], &shuffled[again.order[i]], sizeof(TriangleBox)) == 0);
}
