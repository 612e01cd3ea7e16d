// Top down by the surface area heuristic over bins of centroids (Wald 2007), straight into nodes of 16 children: of the
// parts of a node the dearest is split until there are 16 (as collapsing a binary tree would, Wald et al. 2008).
#include "inputs/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "shared/geometry_types.h"

namespace lightwell {
namespace {

// By how much a box is larger than what it holds, as a share of its coordinates: some ten times the rounding of what kernels
// make of both. Lowered, rays that pass a box's face within rounding miss the triangle on it; raised, more boxes are opened.
constexpr double kMargin = 4e-6;
constexpr std::size_t kBins = 16;
// Fewer leaves than triangles by this factor at least, which bounds the tree; 1 would let a lone large triangle have its own.
constexpr std::size_t kLeast = 4;
constexpr std::size_t kMost = LW_TRIANGLE_GROUP;

// From the parts with more items than this on bins along the longest axis alone: there one is as good as another, and
// three axes take twice the time.
constexpr std::size_t kMany = 1024;
// Centroids no farther apart than this, m, are at one place: bins would be so narrow that their number overflows.
constexpr float kOnePlace = 1e-36f;

// Lower bounds, then negated upper ones, four each, so that growing is one operation on vectors.
struct Bounds {
    std::array<float, 8> v;
    Bounds() { v.fill(std::numeric_limits<float>::infinity()); }
    void add(const Bounds& other) {
        for (std::size_t i = 0; i < 8; ++i) v[i] = other.v[i] < v[i] ? other.v[i] : v[i];
    }
    float lower(std::size_t axis) const { return v[axis]; }
    float upper(std::size_t axis) const { return -v[4 + axis]; }
    float extent(std::size_t axis) const { return upper(axis) - lower(axis); }
    // Half of it; 0 of none.
    double area() const {
        const double x = double(extent(0)), y = double(extent(1)), z = double(extent(2));
        return x >= 0.0 ? x * y + y * z + z * x : 0.0;
    }
};

struct Item {
    Bounds box;
    std::uint32_t triangle;
    float centre(std::size_t axis) const { return box.v[axis] - box.v[4 + axis]; }  // twice
    Bounds centres() const {
        Bounds point;
        for (std::size_t c = 0; c < 4; ++c) point.v[4 + c] = -(point.v[c] = box.v[c] - box.v[4 + c]);
        return point;
    }
};

struct Part {
    std::size_t first = 0, count = 0;
    Bounds bounds, centres;
    // What opening its leaves costs a ray that meets the box, times how often one does.
    static double costOf(std::size_t count, double area) { return double((count + kMost - 1) / kMost) * area; }
    double cost() const { return costOf(count, bounds.area()); }
};

struct Bin {
    Bounds bounds;
    std::size_t count = 0;
};

// Which bin along an axis an item is in.
struct Bins {
    std::size_t axis;
    float lower, scale;
    Bins(const Part& part, std::size_t a)
        : axis(a), lower(part.centres.lower(a)), scale(float(kBins) / part.centres.extent(a)) {}
    std::size_t of(const Item& item) const {
        return std::min(std::size_t(int((item.centre(axis) - lower) * scale)), kBins - 1);
    }
};

// Items left of `bin` of so many bins along `axis` come first.
struct Split {
    std::size_t axis = 0, bin = 0;
    double cost = std::numeric_limits<double>::infinity();
    Bounds left, right;
};

class Builder {
public:
    Builder(const std::vector<TriangleBox>& boxes, const TriangleOrder& isBefore)
        : isBefore_(isBefore), items_(boxes.size()), spare_(boxes.size()) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                items_[i].box.v[c] = boxes[i].lower[c];
                items_[i].box.v[4 + c] = -boxes[i].upper[c];
            }
            items_[i].box.v[3] = items_[i].box.v[7] = 0.0f;
            items_[i].triangle = std::uint32_t(i);
        }
    }

    TriangleTree build() {
        if (!items_.empty()) addNode(partOf(0, items_.size()), 0);
        for (const Item& item : items_) tree_.order.push_back(item.triangle);
        return std::move(tree_);
    }

    std::vector<float> rootAlone() {
        const std::size_t root = emptyNode();
        if (items_.empty()) return std::move(tree_.nodes);
        const std::vector<Part> parts = childrenOf(partOf(0, items_.size()), 0);
        for (std::size_t child = 0; child < parts.size(); ++child) writeBox(nodeAt(root), child, parts[child].bounds);
        return std::move(tree_.nodes);
    }

private:
    Part partOf(std::size_t first, std::size_t count) const {
        Part part;
        part.first = first;
        part.count = count;
        for (std::size_t i = first; i < first + count; ++i) {
            part.bounds.add(items_[i].box);
            part.centres.add(items_[i].centres());
        }
        return part;
    }

    void improve(Split& best, const Part& part, std::size_t axis) const {
        std::array<Bin, kBins> bins;
        const Bins binning(part, axis);
        for (std::size_t i = part.first; i < part.first + part.count; ++i) {
            Bin& bin = bins[binning.of(items_[i])];
            bin.bounds.add(items_[i].box);
            ++bin.count;
        }
        std::array<Bounds, kBins> right;
        for (std::size_t b = kBins - 1; b > 0; --b) {
            right[b] = bins[b].bounds;
            if (b + 1 < kBins) right[b].add(right[b + 1]);
        }
        Bounds left;
        std::size_t count = 0;
        for (std::size_t b = 1; b < kBins; ++b) {
            left.add(bins[b - 1].bounds);
            count += bins[b - 1].count;
            if (count < kLeast || part.count - count < kLeast) continue;
            const double cost = Part::costOf(count, left.area()) + Part::costOf(part.count - count, right[b].area());
            if (cost < best.cost) best = {axis, b, cost, left, right[b]};
        }
    }

    Split bestSplit(const Part& part) const {
        Split best;
        std::size_t longest = 0;
        for (std::size_t axis = 1; axis < 3; ++axis)
            if (part.centres.extent(axis) > part.centres.extent(longest)) longest = axis;
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (part.centres.extent(axis) > kOnePlace && (axis == longest || part.count <= kMany)) improve(best, part, axis);
        return best;
    }

    void sort(const Part& part) {
        const auto first = items_.begin() + std::ptrdiff_t(part.first);
        std::sort(first, first + std::ptrdiff_t(part.count),
                  [&](const Item& a, const Item& b) { return isBefore_(a.triangle, b.triangle); });
    }

    // The part in two; in halves where no split by bins is possible.
    std::pair<Part, Part> divide(const Part& part) {
        const Split split = bestSplit(part);
        if (split.bin == 0) return halve(part);
        Part left, right;
        const Bins binning(part, split.axis);
        left.first = part.first;
        for (std::size_t i = part.first; i < part.first + part.count; ++i) {
            const Item& item = items_[i];
            if (binning.of(item) < split.bin) {
                left.centres.add(item.centres());
                items_[left.first + left.count++] = item;
            } else {
                right.centres.add(item.centres());
                spare_[right.count++] = item;
            }
        }
        right.first = left.first + left.count;
        std::copy_n(spare_.begin(), right.count, items_.begin() + std::ptrdiff_t(right.first));
        left.bounds = split.left;
        right.bounds = split.right;
        return {left, right};
    }

    std::pair<Part, Part> halve(const Part& part) {
        sort(part);
        const std::size_t half = part.count / 2;
        return {partOf(part.first, half), partOf(part.first + half, part.count - half)};
    }

    // At most 16 parts. Deep down in a tree that has grown crooked: halves, so that it ends within LW_TREE_LEVELS.
    std::vector<Part> childrenOf(const Part& whole, std::size_t level) {
        double room = double(kMost);
        for (std::size_t l = level; l < LW_TREE_LEVELS - 1; ++l) room *= LW_TREE_CHILDREN;
        const bool crooked = double(whole.count) > room / 2.0;
        std::vector<Part> parts = {whole};
        while (parts.size() < LW_TREE_CHILDREN) {
            const auto worth = [&](const Part& p) { return p.count <= kMost ? -1.0 : crooked ? double(p.count) : p.cost(); };
            const auto dearest = std::max_element(parts.begin(), parts.end(),
                                                  [&](const Part& a, const Part& b) { return worth(a) < worth(b); });
            if (worth(*dearest) < 0.0) break;
            const auto [left, right] = crooked ? halve(*dearest) : divide(*dearest);
            *dearest = left;
            parts.push_back(right);
        }
        return parts;
    }

    static void writeBox(float* node, std::size_t child, const Bounds& box) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double lower = double(box.lower(c)), upper = double(box.upper(c));
            const float centre = float((lower + upper) * 0.5);
            const double half = std::max(upper - double(centre), double(centre) - lower);
            node[16 * c + child] = centre;
            node[LW_TREE_HALF + 16 * c + child] = std::nextafter(float(half + kMargin * (std::abs(double(centre)) + half)),
                                                                 std::numeric_limits<float>::infinity());
        }
    }

    std::size_t emptyNode() {
        const std::size_t number = tree_.nodes.size() / LW_TREE_NODE;
        tree_.nodes.resize(tree_.nodes.size() + LW_TREE_NODE, 0.0f);
        std::fill_n(tree_.nodes.begin() + std::ptrdiff_t(number * LW_TREE_NODE + LW_TREE_HALF), 48, -1.0f);
        return number;
    }
    float* nodeAt(std::size_t number) { return tree_.nodes.data() + number * LW_TREE_NODE; }

    std::size_t addNode(const Part& whole, std::size_t level) {
        const std::size_t number = emptyNode();
        const std::vector<Part> parts = childrenOf(whole, level);
        for (std::size_t child = 0; child < parts.size(); ++child) {
            const Part& part = parts[child];
            const bool isLeaf = part.count <= kMost;
            if (isLeaf) sort(part);
            const std::int32_t at = std::int32_t(isLeaf ? part.first : addNode(part, level + 1)), count = std::int32_t(isLeaf ? part.count : 0);
            float* const node = nodeAt(number);
            writeBox(node, child, part.bounds);
            std::memcpy(node + LW_TREE_CHILD + child, &at, sizeof at);
            std::memcpy(node + LW_TREE_COUNT + child, &count, sizeof count);
        }
        return number;
    }

    const TriangleOrder& isBefore_;
    std::vector<Item> items_, spare_;
    TriangleTree tree_;
};

}  // namespace

TriangleTree triangleTreeOf(const std::vector<TriangleBox>& boxes, const TriangleOrder& isBefore) {
    return Builder(boxes, isBefore).build();
}

std::vector<float> boxesAround(const std::vector<TriangleBox>& boxes) {
    return Builder(boxes, std::less<std::uint32_t>()).rootAlone();
}

// Of N nodes those whose children are all leaves, B, hold 17 triangles or more, so B <= n / 17; the others have 16 children. Leaves
// hold kLeast, so there are n / 4 at most. Each node but the root and each leaf is a child: 16 (N - B) + 2 B <= N - 1 + n / 4, and
// N <= 0.072 n.
std::uint64_t mostTreeNodes(std::uint64_t triangles) { return triangles == 0 ? 0 : triangles / 13 + 1; }

}  // namespace lightwell
