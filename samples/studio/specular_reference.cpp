#include "specular_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "integrator.h"

namespace studio {
namespace {

// A half-vector about z of the distribution D(h) (n.h).
glm::vec3 sampleHalf(float alpha, glm::vec2 point) {
    const float tangent = alpha * std::sqrt(point.x / std::max(1.0f - point.x, 1e-7f)),
                theta = std::atan(tangent), angle = 2.0f * kPi * point.y;
    return {std::sin(theta) * std::cos(angle), std::sin(theta) * std::sin(angle), std::cos(theta)};
}

glm::vec3 mirrored(const glm::vec3& v, const glm::vec3& h) {
    return 2.0f * glm::dot(v, h) * h - v;
}

// Weight of a direction: n.l, of those above the surface that half-vectors on the eye's side make.
float weightOf(const glm::vec3& v, const glm::vec3& h, const glm::vec3& n) {
    return glm::dot(v, h) > 0.0f ? std::max(0.0f, glm::dot(mirrored(v, h), n)) : 0.0f;
}

// The mean weight of all half-vectors, by the cosine between view and normal.
class MeanWeights {
public:
    explicit MeanWeights(float alpha) {
        constexpr int kPoints = 4096;
        for (std::size_t i = 0; i < table_.size(); ++i) {
            const float cosine = float(i) / float(table_.size() - 1);
            const glm::vec3 v{std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine};
            double sum = 0.0;
            for (int p = 0; p < kPoints; ++p)
                sum += double(weightOf(
                    v,
                    sampleHalf(alpha, {(float(p) + 0.5f) / float(kPoints),
                                       float(reverseBits(std::uint32_t(p)) >> 8) / 16777216.0f}),
                    {0.0f, 0.0f, 1.0f}));
            table_[i] = float(sum / kPoints);
        }
    }
    float at(float cosine) const {
        const float x = std::min(std::max(cosine, 0.0f), 1.0f) * float(table_.size() - 1);
        const std::size_t i = std::min(std::size_t(x), table_.size() - 2);
        return table_[i] + (x - float(i)) * (table_[i + 1] - table_[i]);
    }

private:
    std::array<float, 257> table_{};
};

}  // namespace

Film traceSpecular(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
                   const PathTracerOptions& options) {
    Film film(view.width, view.height, {"specular"}, 2);
    const int most = options.untilRelMse > 0.0 ? options.maxSamplesPerPixel : options.samplesPerPixel;
    Run run(scene, view, pixels, options, film, std::uint32_t(options.samplesPerPixel / 2),
            std::uint32_t(most / 2));
    const float alpha = float(options.specular->roughness * options.specular->roughness);
    const MeanWeights means(alpha);

    const auto radiance = [&](const Surface& at, const glm::vec3& direction) {
        if (glm::dot(at.geometricNormal, direction) <= 0.0f) return glm::vec3(0.0f);
        Hit hit;
        if (!scene.trace(scene.offset(at.position, at.geometricNormal), direction, 0.0f,
                         std::numeric_limits<float>::infinity(), hit))
            return scene.scene().sky;
        return hit.albedo * scene.directIrradiance(hit.position, hit.geometricNormal, hit.normal) *
               (1.0f / kPi);
    };
    run.fill([&](const Tile& tile, std::uint32_t first, std::uint32_t last) {
        forEachPixel(tile, film, pixels, [&](std::size_t pixel) {
            const Surface& at = pixels.surface[pixel];
            const glm::vec3 n = at.normal;
            glm::vec3 v = glm::normalize(view.camera.position - at.position);
            v -= 2.0f * std::min(0.0f, glm::dot(v, n)) * n;
            const glm::vec3 away = std::abs(n.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
            const glm::vec3 t = glm::normalize(glm::cross(n, away)), b = glm::cross(n, t);
            const float mean = std::max(means.at(glm::dot(v, n)), 1e-6f);
            for (int half = 0; half < 2; ++half)
                for (std::uint32_t s = first; s < last; ++s) {
                    Sampler sampler(options.seed, 2 * pixel + std::size_t(half), s);
                    const glm::vec3 local = sampleHalf(alpha, sampler.next()),
                                    h = local.x * t + local.y * b + local.z * n;
                    const float weight = weightOf(v, h, n);
                    if (weight > 0.0f)
                        film.at(pixel, half)[0] +=
                            glm::dvec3(weight / mean * radiance(at, mirrored(v, h)));
                }
        });
    });
    return film;
}

}  // namespace studio
