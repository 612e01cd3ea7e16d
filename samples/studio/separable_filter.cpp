// Row and column passes written so that the inner loop runs along a row and vectorises.
#include "separable_filter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace studio {
namespace {

// Index of the pixel that stands for `i`, which may lie any distance outside [0, size).
int inside(int i, int size, Border border) {
    if (border == Border::Clamp) return std::clamp(i, 0, size - 1);
    const int period = 2 * size;
    const int folded = ((i % period) + period) % period;
    return folded < size ? folded : period - 1 - folded;
}

template <class T>
void addScaled(T* __restrict to, const T* __restrict from, T weight, int count) {
    for (int i = 0; i < count; ++i) to[i] += weight * from[i];
}

}  // namespace

template <class T>
std::vector<T> filterRows(const std::vector<T>& plane, int width, int height,
                          const std::vector<T>& kernel, Border border) {
    const int radius = int(kernel.size()) / 2;
    std::vector<T> result(plane.size(), T(0));
    std::vector<T> padded(std::size_t(width + 2 * radius));
    for (int y = 0; y < height; ++y) {
        const T* row = plane.data() + std::size_t(y) * std::size_t(width);
        std::copy(row, row + width, padded.begin() + radius);
        for (int k = 1; k <= radius; ++k) {
            padded[std::size_t(radius - k)] = row[inside(-k, width, border)];
            padded[std::size_t(radius + width - 1 + k)] = row[inside(width - 1 + k, width, border)];
        }
        T* to = result.data() + std::size_t(y) * std::size_t(width);
        for (std::size_t k = 0; k < kernel.size(); ++k)
            addScaled(to, padded.data() + k, kernel[k], width);
    }
    return result;
}

template <class T>
std::vector<T> filterColumns(const std::vector<T>& plane, int width, int height,
                             const std::vector<T>& kernel, Border border) {
    const int radius = int(kernel.size()) / 2;
    std::vector<T> result(plane.size(), T(0));
    for (int y = 0; y < height; ++y) {
        T* to = result.data() + std::size_t(y) * std::size_t(width);
        for (int k = -radius; k <= radius; ++k) {
            const std::size_t from = std::size_t(inside(y + k, height, border));
            addScaled(to, plane.data() + from * std::size_t(width), kernel[std::size_t(radius + k)],
                      width);
        }
    }
    return result;
}

template <class T>
std::vector<T> gaussianKernel(double sigma, int radius) {
    std::vector<double> weights;
    double sum = 0.0;
    for (int x = -radius; x <= radius; ++x) {
        weights.push_back(std::exp(-0.5 * x * x / (sigma * sigma)));
        sum += weights.back();
    }
    std::vector<T> kernel;
    for (double weight : weights) kernel.push_back(T(weight / sum));
    return kernel;
}

template std::vector<float> filterRows(const std::vector<float>&, int, int, const std::vector<float>&,
                                       Border);
template std::vector<double> filterRows(const std::vector<double>&, int, int, const std::vector<double>&,
                                        Border);
template std::vector<float> filterColumns(const std::vector<float>&, int, int, const std::vector<float>&,
                                          Border);
template std::vector<double> filterColumns(const std::vector<double>&, int, int,
                                           const std::vector<double>&, Border);
template std::vector<float> gaussianKernel(double, int);
template std::vector<double> gaussianKernel(double, int);

}  // namespace studio
