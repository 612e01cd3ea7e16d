// Where the error of a technique that gathers from virtual point lights comes from: each of its
// approximations replaced by exact in turn, the error lost with it is its share.
//
// Of one picture T drawn from N VPLs, with R1 the truth of as many bounces as the technique models and R
// that of all:
// clang-format off
//     model        T  -> T + (R - R1)   the bounces it leaves out are added, exact
//     resolution      -> F              every pixel its own surface and every VPL (no halves, no interleave)
//     visibility      -> V              a shadow ray for each pixel and VPL
//     sampling        -> <V>            the mean over infinitely many patterns of N VPLs
//     bounding        -> R1             what is left: the bounded geometry term, and the RSM's own texels; also
//                                       light that stands in no RSM at all (a sky, glowing surfaces)
// clang-format on
//
// All errors are <(. - truth)^2 / (R^2 + 0.01 <R>^2)>, the relMSE of docs/accuracy.md, with one and the
// same denominator, so that the shares add up to the relMSE of T against R. A share is negative where an
// approximation hides the error of another: light without visibility is too much, bounces left out are
// too little.
#pragma once

#include <optional>
#include <vector>

#include "image.h"

namespace studio {

struct ErrorSplit {
    double total = 0.0;  // relMSE of T against all bounces; the sum of what follows
    double model = 0.0, resolution = 0.0, visibility = 0.0;
    // Apart only with two patterns or more; one alone leaves their sum in `bounding`.
    std::optional<double> sampling;
    double bounding = 0.0;
};

// The expectation over patterns, from a few. The split of <V> is unbiased: the variance of V about its
// own mean, taken over S patterns with S - 1, is the sampling's share; the rest of V's error is the
// bounding's, which the truth's own noise adds to.
class ErrorSplitter {
public:
    // R, G, B of both (W/m^2), normal.* tells surfaces; `all` may be `own` itself. Throws
    // std::runtime_error when sizes differ, layers are missing or not finite, or `all` is black.
    ErrorSplitter(const Image& own, const Image& all);
    // One pattern's pictures (R, G, B): as rendered, at full resolution, with exact visibility. Throws
    // std::runtime_error when sizes differ or a value is not finite.
    void add(const Image& rendered, const Image& fullResolution, const Image& exactVisibility);
    int patterns() const { return patterns_; }
    // Throws std::logic_error before the first pattern.
    ErrorSplit result() const;

private:
    std::vector<double> flatten(const Image& image) const;
    double error(const std::vector<double>& picture, const std::vector<double>& truth) const;

    int width_ = 0, height_ = 0;
    std::vector<std::size_t> pixels_;                // those that show a surface
    std::vector<double> own_, all_, inverseWeight_;  // of each pixel and channel
    std::vector<double> sum_, sumOfSquares_;         // of V
    double total_ = 0.0, modelled_ = 0.0, full_ = 0.0, visible_ = 0.0;
    int patterns_ = 0;
};

}  // namespace studio
