// Filtering of planes by separable kernels: the windows of SSIM and FLIP.
#pragma once

#include <vector>

namespace studio {

// What lies beyond the border: the outermost pixel again (aaa|abc), or the mirror image (cba|abc).
enum class Border { Clamp, Mirror };

// Kernels have an odd number of weights, the centre in the middle; the result at x is the sum of
// kernel[radius + k] * plane[x + k]. T: float or double.
template <class T>
std::vector<T> filterRows(const std::vector<T>& plane, int width, int height,
                          const std::vector<T>& kernel, Border border);
template <class T>
std::vector<T> filterColumns(const std::vector<T>& plane, int width, int height,
                             const std::vector<T>& kernel, Border border);

// exp(-x^2 / (2 sigma^2)) at x = -radius ... radius, normalised to sum 1.
template <class T>
std::vector<T> gaussianKernel(double sigma, int radius);

}  // namespace studio
