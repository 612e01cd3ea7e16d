// Lit points: sampling the surfaces that punctual lights reach, by rays from the lights.
//
// Source: the light's end of bidirectional path tracing (E. Veach 1997, chapter 10), with one vertex
// from the light. Where the sun lights a strip of floor that few cosine-sampled rays meet, such points
// bring most of the light with a fraction of the noise; the integrator joins both by the balance
// heuristic, so that a poor choice of cells costs time but no accuracy.
//
// Rays are chosen from a grid of cells over each light's rays. A cell's probability is its share of the
// light that a few of the receivers would get from it (one ray for each cell, bounded point-to-disc
// term), mixed with its share of all reflected flux, for receivers that paths reach later.
#include "lit_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "film.h"
#include "parallel.h"
#include "sun_fit.h"

namespace studio {
namespace {

// Cells along a side of a light's square of rays, and in all of it.
constexpr std::size_t kSide = 128, kCells = kSide * kSide;

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr double kTwoPi = 6.283185307179586;

// Receivers that a cell's importance is judged by. More: a longer start; fewer: cells that matter to a
// small part of the picture are found too rarely.
constexpr std::size_t kJudges = 48;

// Shares of the samples given out by flux alone, and to all cells alike: the one ray of a cell may miss
// what is lit in it.
constexpr double kByFlux = 0.2, kAlike = 0.02;

float largest(const glm::vec3& c) {
    return std::max(c.x, std::max(c.y, c.z));
}

// A place in a cell's part of the unit square.
glm::dvec2 inCell(std::size_t cell, glm::dvec2 place) {
    return (glm::dvec2(double(cell % kSide), double(cell / kSide)) + place) / double(kSide);
}

std::vector<Surface> someOf(const std::vector<Surface>& receivers) {
    if (receivers.size() <= kJudges) return receivers;
    std::vector<Surface> chosen;
    for (std::size_t i = 0; i < kJudges; ++i) {
        // Anywhere in its part of the list: equal steps would fall into columns of the picture.
        const std::size_t first = i * receivers.size() / kJudges;
        const std::size_t count = (i + 1) * receivers.size() / kJudges - first;
        chosen.push_back(receivers[first + std::size_t(mixBits(i + 1) % count)]);
    }
    return chosen;
}

}  // namespace

LitPoints::Chart::Chart(const RayScene& scene, const Light& chartLight) : light(chartLight) {
    // A point light has no direction of its own: any axis will do.
    const LightAxes axes(light.kind == LightKind::Point ? glm::vec3(0, -1, 0) : light.direction);
    right = axes.right, up = axes.up, back = axes.back;
    if (light.kind == LightKind::Sun) {
        glm::vec3 low, high;
        scene.boundsAlong(axes.rows(), low, high);
        lower = glm::dvec2(low), upper = glm::dvec2(high);
        nearBack = double(high.z) + 1e-3 * double(scene.diagonal());
        measure = (upper.x - lower.x) * (upper.y - lower.y);
    } else {
        cap = light.kind == LightKind::Point ? 2.0 : 1.0 - std::cos(double(light.outerCone));
        measure = kTwoPi * cap;
    }
}

LitPoints::Ray LitPoints::Chart::rayAt(glm::dvec2 square) const {
    if (light.kind == LightKind::Sun) {
        const glm::dvec2 at = lower + (upper - lower) * square;
        return {glm::vec3(right * at.x + up * at.y + back * nearBack), light.direction};
    }
    const double z = 1.0 - cap * square.y, r = std::sqrt(std::max(0.0, 1.0 - z * z));
    const double angle = kTwoPi * square.x;
    return {light.position,
            glm::vec3(right * (r * std::cos(angle)) + up * (r * std::sin(angle)) - back * z)};
}

glm::dvec2 LitPoints::Chart::squareOf(const glm::vec3& position) const {
    if (light.kind == LightKind::Sun) {
        const glm::dvec3 p(position);
        return (glm::dvec2(glm::dot(p, right), glm::dot(p, up)) - lower) / (upper - lower);
    }
    const glm::dvec3 w = glm::normalize(glm::dvec3(position) - glm::dvec3(light.position));
    const double turn = std::atan2(glm::dot(w, up), glm::dot(w, right)) / kTwoPi;
    return {turn < 0.0 ? turn + 1.0 : turn, (1.0 + glm::dot(w, back)) / cap};
}

double LitPoints::Chart::measurePerArea(const glm::vec3& position,
                                        const glm::vec3& geometricNormal) const {
    if (light.kind == LightKind::Sun)
        return std::abs(double(glm::dot(geometricNormal, light.direction)));
    const glm::dvec3 way = glm::dvec3(position) - glm::dvec3(light.position);
    const double squared = glm::dot(way, way);
    return std::abs(glm::dot(glm::dvec3(geometricNormal), way)) / (squared * std::sqrt(squared));
}

LitPoints::LitPoints(const RayScene& scene, const std::vector<Surface>& receivers, bool occlusion,
                     const SeenSurfaces* senders)
    : scene_(scene) {
    for (const Light& light : scene.lights()) charts_.emplace_back(scene, light);
    const std::vector<Surface> judges = someOf(receivers);
    std::vector<double> flux(charts_.size() * kCells, 0.0), useful(flux.size(), 0.0);
    parallelFor(charts_.size() * kSide, 0, [&](std::size_t row) {
        for (std::size_t cell = row * kSide; cell < (row + 1) * kSide; ++cell) {
            const Chart& chart = charts_[cell / kCells];
            const Ray ray = chart.rayAt(inCell(cell % kCells, {0.5, 0.5}));
            Hit hit;
            if (!scene.trace(ray.origin, ray.direction, 0.0f, kFar, hit)) continue;
            const double perArea = chart.measurePerArea(hit.position, hit.geometricNormal);
            if (perArea <= 0.0) continue;
            const double area = chart.measure / kCells / perArea;
            const glm::vec3 facing = arrivalOf(chart.light, hit.position).irradiance;
            const float cosine = -glm::dot(hit.geometricNormal, ray.direction);
            flux[cell] = double(largest(hit.albedo * facing) * cosine) * area;
            if (senders == nullptr || senders->contains(hit.position, hit.geometricNormal))
                useful[cell] = flux[cell] * transfer(hit, area, judges, occlusion);
        }
    });
    chooseCells(flux, useful);
}

LitPoints::LitPoints(const RayScene& scene, const LitPoints& like)
    : scene_(scene), probability_(like.probability_), upTo_(like.upTo_) {
    for (const Light& light : scene.lights()) charts_.emplace_back(scene, light);
    if (charts_.size() != like.charts_.size())
        throw std::invalid_argument(fmt::format("lit points: expected a scene of {} lights, got {}",
                                                like.charts_.size(), charts_.size()));
}

std::uint64_t LitPoints::hash() const {
    return hashBytes(probability_.data(), probability_.size() * sizeof(double), 4);
}

double LitPoints::transfer(const Hit& hit, double area, const std::vector<Surface>& judges,
                           bool occlusion) const {
    double sum = 0.0;
    const glm::vec3 from = scene_.offset(hit.position, hit.geometricNormal);
    for (const Surface& judge : judges) {
        const glm::vec3 way = scene_.offset(judge.position, judge.geometricNormal) - from;
        const float squared = glm::dot(way, way), distance = std::sqrt(squared);
        const float cosine = -glm::dot(judge.normal, way), litCosine = glm::dot(hit.normal, way);
        if (cosine <= 0.0f || litCosine <= 0.0f || distance <= 0.0f) continue;
        if (occlusion && scene_.occluded(from, way / distance, 0.0f, distance)) continue;
        const double cosines = double(cosine) * double(litCosine) / double(squared);
        sum += cosines / (double(squared) + double(litCosine / distance) * area / double(kPi));
    }
    return sum;
}

void LitPoints::chooseCells(const std::vector<double>& flux, const std::vector<double>& useful) {
    const double allFlux = std::accumulate(flux.begin(), flux.end(), 0.0);
    const double allUseful = std::accumulate(useful.begin(), useful.end(), 0.0);
    if (allFlux <= 0.0) return;
    const double byFlux = allUseful > 0.0 ? kByFlux : 1.0 - kAlike;
    double sum = 0.0;
    for (std::size_t i = 0; i < flux.size(); ++i) {
        double share = kAlike / double(flux.size()) + byFlux * flux[i] / allFlux;
        if (allUseful > 0.0) share += (1.0 - byFlux - kAlike) * useful[i] / allUseful;
        probability_.push_back(share);
        upTo_.push_back(sum += share);
    }
}

bool LitPoints::sample(const glm::dvec2& fine, Point& point) const {
    // One pair chooses the cell and, with what is left of it, the place there: it stays stratified.
    const double choice = fine.x * upTo_.back();
    const auto found = std::upper_bound(upTo_.begin(), upTo_.end() - 1, choice);
    const auto cell = std::size_t(found - upTo_.begin());
    const double left = (choice - upTo_[cell] + probability_[cell]) / probability_[cell];
    const std::size_t light = cell / kCells;
    const Ray ray = charts_[light].rayAt(inCell(cell % kCells, {std::clamp(left, 0.0, 1.0), fine.y}));
    Hit hit;
    if (!scene_.trace(ray.origin, ray.direction, 0.0f, kFar, hit)) return false;
    point.surface = {hit.position, hit.geometricNormal, hit.normal};
    point.albedo = hit.albedo;
    point.light = light;
    point.density = density(light, hit.position, hit.geometricNormal);
    return point.density > 0.0f;
}

float LitPoints::density(std::size_t light, const glm::vec3& position,
                         const glm::vec3& geometricNormal) const {
    const Chart& chart = charts_[light];
    const glm::dvec2 square = chart.squareOf(position);
    // Negated, so that a point at the light's very place (NaN) is outside.
    if (!(square.x >= 0.0 && square.x < 1.0 && square.y >= 0.0 && square.y < 1.0)) return 0.0f;
    const auto column = std::size_t(square.x * kSide), row = std::size_t(square.y * kSide);
    const double inMeasure =
        probability_[light * kCells + row * kSide + column] * kCells / chart.measure;
    return float(inMeasure * chart.measurePerArea(position, geometricNormal));
}

}  // namespace studio
