// The probes of a frame by their definition in docs/planner.md, serially and in double precision.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "passes/frame_figures.h"
#include "shared/frame_probes_types.h"

namespace lightwell::test {

struct ProbeSurface {
    glm::dvec3 position{0.0}, normal{0.0};
    bool isSurface = false;
};

// A view as the twin knows it: its pixels, and by what rule its camera sees, without matrices.
struct ProbedPicture {
    std::uint32_t width = 0, height = 0;
    std::vector<ProbeSurface> pixels;
    std::vector<glm::dvec3> albedo, radiance;  // may be none
    bool hasCamera = true;
    glm::dvec3 eye{0.0}, right{0.0}, up{0.0}, forward{0.0};
    double left = 0.0, rightEdge = 0.0, bottom = 0.0, top = 0.0;  // of the window, at distance 1 where it is a perspective
    bool orthographic = false;

    const ProbeSurface& at(std::uint32_t x, std::uint32_t y) const { return pixels[std::size_t(y) * width + x]; }
    double depth(const glm::dvec3& p) const { return glm::dot(p - eye, forward); }
    double scale(double depthOf) const {
        return orthographic ? std::sqrt((rightEdge - left) * (top - bottom)) : std::abs(depthOf);
    }
    // The pixel that shows a place, if any does.
    bool project(const glm::dvec3& p, std::uint32_t& x, std::uint32_t& y) const {
        const double z = depth(p), by = orthographic ? 1.0 : z;
        if (!(by > 0.0)) return false;
        const double u = (glm::dot(p - eye, right) / by - left) / (rightEdge - left);
        const double v = (top - glm::dot(p - eye, up) / by) / (top - bottom);
        if (!(u >= 0.0 && u < 1.0 && v >= 0.0 && v < 1.0)) return false;
        x = std::min(std::uint32_t(u * width), width - 1);
        y = std::min(std::uint32_t(v * height), height - 1);
        return true;
    }
};

struct ProbedTexel {
    glm::dvec3 position{0.0}, normal{0.0}, flux{0.0};
    double area = 0.0;
    bool isSurface = false;
};
struct ProbedMap {
    std::uint32_t width = 0, height = 0;
    std::vector<ProbedTexel> texels;
};

class FrameProbesTwin {
public:
    FrameProbesTwin(const ProbedPicture& picture, const std::vector<ProbedMap>& maps) : picture_(picture) {
        sample(maps);
        draw();
    }

    FrameFigures probes() const {
        constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
        const bool lit = total_ > 0.0;
        Sums sums;
        for (std::uint32_t row = 0; row < LW_PROBE_ROWS; ++row)
            for (std::uint32_t column = 0; column < LW_PROBE_COLUMNS; ++column) addPixel(column, row, sums);
        double shown = 0.0, squares = 0.0;
        for (const Sample& s : samples_) {
            shown += s.isShown ? s.weight : 0.0;
            squares += s.weight * s.weight;
        }
        FrameFigures probes;
        const auto ratio = [&](double part, double whole, bool has) { return float(has && whole > 0.0 ? part / whole : kNone); };
        probes.indirectShare = ratio(sums.indirect, sums.indirect + sums.direct, lit && !picture_.albedo.empty() && !picture_.radiance.empty());
        probes.fluxOnScreen = ratio(shown, total_, lit && picture_.hasCamera);
        probes.fluxConcentration = ratio(squares, total_ * total_, lit);
        probes.depthComplexity = ratio(sums.edges, sums.neighbours, picture_.hasCamera);
        std::vector<glm::dvec3> seen, lighted;
        for (const glm::dvec3& p : sums.places) seen.push_back(p);
        for (const Sample& s : samples_)
            if (s.texel.isSurface) lighted.push_back(s.texel.position);
        probes.extent = ratio(radius(seen), radius(lighted), !seen.empty() && !lighted.empty());
        probes.albedo = ratio(sums.albedo, double(sums.places.size()), !picture_.albedo.empty());
        probes.facing = ratio(sums.facing, double(sums.places.size() * emitters_.size()), lit);
        probes.hidden = ratio(sums.hidden, sums.tested, lit && picture_.hasCamera);
        probes.coverage = ratio(double(sums.places.size()), LW_PROBE_COLUMNS * LW_PROBE_ROWS, true);
        return probes;
    }

private:
    struct Sample {
        ProbedTexel texel;
        double weight = 0.0;
        bool isShown = false;
    };
    struct Sums {
        double indirect = 0.0, direct = 0.0, albedo = 0.0, facing = 0.0, tested = 0.0, hidden = 0.0, neighbours = 0.0, edges = 0.0;
        std::vector<glm::dvec3> places;
    };
    static double luminance(const glm::dvec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }
    static double radius(const std::vector<glm::dvec3>& places) {
        glm::dvec3 mean(0.0);
        for (const glm::dvec3& p : places) mean += p / double(places.size());
        double sum = 0.0;
        for (const glm::dvec3& p : places) sum += glm::dot(p - mean, p - mean);
        return std::sqrt(sum / double(places.size()));
    }

    void sample(const std::vector<ProbedMap>& maps) {
        std::uint32_t side = 1;
        while ((side + 1) * (side + 1) * maps.size() <= LW_PROBE_TEXELS) ++side;
        std::uint32_t index = 0;
        for (const ProbedMap& map : maps)
            for (std::uint32_t row = 0; row < side; ++row)
                for (std::uint32_t column = 0; column < side; ++column, ++index) {
                    // In float as the kernel: which texel it is hangs on it.
                    const float at = (float(column) + lw_probe_jitter(2 * index)) * float(map.width) / float(side);
                    const float below = (float(row) + lw_probe_jitter(2 * index + 1)) * float(map.height) / float(side);
                    const std::uint32_t x = std::min(std::uint32_t(at), map.width - 1), y = std::min(std::uint32_t(below), map.height - 1);
                    Sample s;
                    s.texel = map.texels[std::size_t(y) * map.width + x];
                    const double cells = double(map.width) * map.height / (double(side) * side);
                    s.weight = s.texel.isSurface ? (s.texel.flux.x + s.texel.flux.y + s.texel.flux.z) / 3.0 * cells : 0.0;
                    s.isShown = picture_.hasCamera && s.texel.isSurface && isShown(s.texel);
                    total_ += s.weight;
                    samples_.push_back(s);
                }
    }
    bool isShown(const ProbedTexel& t) const {
        std::uint32_t x = 0, y = 0;
        if (!picture_.project(t.position, x, y)) return false;
        const ProbeSurface& s = picture_.at(x, y);
        const double scale = picture_.scale(picture_.depth(t.position));
        const glm::dvec3 off = t.position - s.position;
        return s.isSurface && std::abs(glm::dot(s.normal, off)) <= double(LW_PROBE_PLANE) * scale && glm::dot(s.normal, t.normal) > 0.0 &&
               std::abs(glm::dot(picture_.forward, off)) <= double(LW_PROBE_DEPTH) * scale;
    }
    void draw() {
        if (!(total_ > 0.0)) return;
        for (int k = 0; k < LW_PROBE_EMITTERS; ++k) {
            const double target = (k + 0.5) / LW_PROBE_EMITTERS * total_;
            double sum = 0.0;
            std::size_t chosen = 0;
            for (std::size_t i = 0; i < samples_.size(); ++i) {
                if (!(samples_[i].weight > 0.0)) continue;
                chosen = i;
                sum += samples_[i].weight;
                if (sum > target) break;
            }
            ProbedTexel e = samples_[chosen].texel;
            const double factor = total_ / LW_PROBE_EMITTERS / ((e.flux.x + e.flux.y + e.flux.z) / 3.0);
            e.flux *= factor;
            e.area *= factor;
            emitters_.push_back(e);
        }
    }

    static std::uint32_t gridPlace(std::uint32_t index, std::uint32_t size, int cells) {
        return std::min(std::uint32_t((float(index) + 0.5f) * (float(size) / float(cells))), size - 1);
    }
    void addPixel(std::uint32_t column, std::uint32_t row, Sums& sums) const {
        const std::uint32_t x = gridPlace(column, picture_.width, LW_PROBE_COLUMNS), y = gridPlace(row, picture_.height, LW_PROBE_ROWS);
        const ProbeSurface& s = picture_.at(x, y);
        if (picture_.hasCamera) {
            if (column + 1 < LW_PROBE_COLUMNS) compare(s, picture_.at(gridPlace(column + 1, picture_.width, LW_PROBE_COLUMNS), y), sums);
            if (row + 1 < LW_PROBE_ROWS) compare(s, picture_.at(x, gridPlace(row + 1, picture_.height, LW_PROBE_ROWS)), sums);
        }
        if (!s.isSurface) return;
        sums.places.push_back(s.position);
        const std::size_t at = std::size_t(y) * picture_.width + x;
        glm::dvec3 irradiance(0.0);
        for (const ProbedTexel& e : emitters_) {
            const double w = transfer(s, e);
            sums.facing += w > 0.0 ? 1.0 : 0.0;
            irradiance += e.flux * w;
        }
        if (!picture_.albedo.empty()) {
            sums.indirect += luminance(picture_.albedo[at] * irradiance) / 3.14159265358979;
            sums.albedo += luminance(picture_.albedo[at]);
        }
        if (!picture_.radiance.empty()) sums.direct += luminance(picture_.radiance[at]);
        if (!picture_.hasCamera || emitters_.empty()) return;
        for (int j = 0; j < LW_PROBE_PAIRS; ++j) {
            const std::size_t k = (37 * column + 11 * row + std::uint32_t(j) * (LW_PROBE_EMITTERS / LW_PROBE_PAIRS)) % LW_PROBE_EMITTERS;
            if (!(transfer(s, emitters_[k]) > 0.0)) continue;
            sums.tested += 1.0;
            sums.hidden += isHidden(s, emitters_[k].position) ? 1.0 : 0.0;
        }
    }
    // Irradiance for each watt: the bounded term of docs/conventions.md.
    static double transfer(const ProbeSurface& s, const ProbedTexel& e) {
        constexpr double kPi = 3.14159265358979323846;
        const glm::dvec3 d = e.position - s.position;
        const double squared = glm::dot(d, d);
        if (!(squared > 0.0)) return 0.0;
        const double here = glm::dot(d, s.normal) / std::sqrt(squared), there = -glm::dot(d, e.normal) / std::sqrt(squared);
        if (here <= 0.0 || there <= 0.0) return 0.0;
        return here * there / kPi / (squared + (1.0 + 3.0 * there * there) / 4.0 * e.area / kPi);
    }
    void compare(const ProbeSurface& a, const ProbeSurface& b, Sums& sums) const {
        if (!a.isSurface && !b.isSurface) return;
        sums.neighbours += 1.0;
        const glm::dvec3 d = b.position - a.position;
        const double off = std::min(std::abs(glm::dot(d, a.normal)), std::abs(glm::dot(d, b.normal)));
        const bool isOne = a.isSurface && b.isSurface && off <= double(LW_PROBE_PLANE) * picture_.scale(picture_.depth(a.position));
        sums.edges += isOne ? 0.0 : 1.0;
    }
    bool isHidden(const ProbeSurface& s, const glm::dvec3& to) const {
        for (int k = 1; k <= LW_PROBE_STEPS; ++k) {
            const glm::dvec3 p = s.position + (to - s.position) * (double(k) / (LW_PROBE_STEPS + 1));
            std::uint32_t x = 0, y = 0;
            if (!picture_.project(p, x, y) || !picture_.at(x, y).isSurface) continue;
            const double depth = picture_.depth(p), front = depth - picture_.depth(picture_.at(x, y).position), scale = picture_.scale(depth);
            if (front > double(LW_PROBE_LEAST) * scale && front < double(LW_PROBE_MOST) * scale) return true;
        }
        return false;
    }

    const ProbedPicture& picture_;
    std::vector<Sample> samples_;
    std::vector<ProbedTexel> emitters_;
    double total_ = 0.0;
};

}  // namespace lightwell::test
