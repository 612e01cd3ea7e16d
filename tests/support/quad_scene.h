// Scenes of quads and chosen receivers, built in code, for tests whose truth is known by formula.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "gbuffer.h"

namespace test {

constexpr double kPi = 3.14159265358979323846;

class QuadScene {
public:
    int material(const glm::vec3& albedo, const glm::vec3& emission = glm::vec3(0.0f)) {
        studio::Material m;
        m.albedo = albedo;
        m.emission = emission;
        if (emission != glm::vec3(0.0f)) scene.emissiveSurfaces = true;
        scene.materials.push_back(m);
        return int(scene.materials.size()) - 1;
    }

    // Corners in order around the quad; `normal` shades it (default: its own).
    void quad(int material, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
              const glm::vec3& d, const glm::vec3& normal = glm::vec3(0.0f)) {
        const glm::vec3 own = glm::normalize(glm::cross(b - a, c - a));
        studio::Mesh mesh;
        mesh.material = material;
        mesh.positions = {a, b, c, d};
        mesh.normals.assign(4, normal == glm::vec3(0.0f) ? own : glm::normalize(normal));
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        scene.meshes.push_back(mesh);
    }

    // The six walls of a box.
    void box(int material, const glm::vec3& lo, const glm::vec3& hi) {
        const auto p = [&](int i) {
            return glm::vec3(i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z);
        };
        for (const auto& f : {glm::ivec4(0, 1, 3, 2), glm::ivec4(4, 5, 7, 6), glm::ivec4(0, 1, 5, 4),
                              glm::ivec4(2, 3, 7, 6), glm::ivec4(0, 2, 6, 4), glm::ivec4(1, 3, 7, 5)})
            quad(material, p(f.x), p(f.y), p(f.z), p(f.w));
    }

    void sun(const glm::vec3& direction, const glm::vec3& irradiance) {
        studio::Light light;
        light.kind = studio::LightKind::Sun;
        light.direction = glm::normalize(direction);
        light.emitted = irradiance;
        scene.lights.push_back(light);
    }

    void point(const glm::vec3& position, const glm::vec3& intensity) {
        studio::Light light;
        light.kind = studio::LightKind::Point;
        light.position = position;
        light.emitted = intensity;
        scene.lights.push_back(light);
    }

    studio::RayScene build() const {
        return studio::RayScene(std::make_shared<const studio::Scene>(scene), 0.0f);
    }

    studio::Scene scene;
};

// A G-buffer of receivers chosen by the test; pixels not set have no surface.
class Receivers {
public:
    Receivers(int width, int height, const glm::vec3& eye = glm::vec3(0.0f)) {
        view.width = width;
        view.height = height;
        view.camera.position = eye;
        view.position = studio::PlanarBuffer(width, height, 3);
        view.normal = studio::PlanarBuffer(width, height, 3);
    }

    Receivers& set(int x, int y, const glm::vec3& position, const glm::vec3& normal) {
        view.position.setRgb(x, y, position);
        view.normal.setRgb(x, y, glm::normalize(normal));
        return *this;
    }

    // Cell centres of a grid over the parallelogram at `corner`.
    Receivers& grid(const glm::vec3& corner, const glm::vec3& across, const glm::vec3& down,
                    const glm::vec3& normal) {
        for (int y = 0; y < view.height; ++y)
            for (int x = 0; x < view.width; ++x)
                set(x, y,
                    corner + across * ((float(x) + 0.5f) / float(view.width)) +
                        down * ((float(y) + 0.5f) / float(view.height)),
                    normal);
        return *this;
    }

    studio::GBuffer view;
};

}  // namespace test
