// scene_preview SCENE [CAMERA] [WIDTHxHEIGHT] [PREFIX]: writes PREFIX.albedo.png and PREFIX.direct.png,
// prints what the scene holds and what casting its G-buffer took. A developer's tool.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <string>

#include <fmt/format.h>

#include "gbuffer.h"
#include "image.h"

namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::time_point since) {
    return std::chrono::duration<double>(Clock::now() - since).count();
}

void writeDisplay(const std::string& path, const studio::PlanarBuffer& buffer, float exposure) {
    studio::Image image(buffer.width(), buffer.height());
    const char* names[] = {"R", "G", "B"};
    for (int plane = 0; plane < 3; ++plane) {
        std::vector<float>& out = image.plane(names[plane]);
        for (int y = 0; y < buffer.height(); ++y)
            for (int x = 0; x < buffer.width(); ++x) {
                const float value = buffer.row(plane, y)[x] * exposure;
                const std::size_t at = std::size_t(y) * std::size_t(buffer.width()) + std::size_t(x);
                out[at] = value < 1.0f ? value : 1.0f;
            }
    }
    studio::writePng(path, image);
}

int run(int argc, char** argv) {
    if (argc < 2) {
        for (const studio::SceneEntry& entry : studio::listScenes())
            fmt::print("{}{}  {}\n", entry.name, entry.shipped ? " (shipped)" : "", entry.path);
        return 0;
    }
    int width = 640, height = 360;
    if (argc > 3 && std::sscanf(argv[3], "%dx%d", &width, &height) != 2) return 2;
    auto start = Clock::now();
    const auto scene = std::make_shared<studio::Scene>(studio::loadScene(argv[1]));
    const double load = seconds(start);
    start = Clock::now();
    const studio::RayScene rays(scene, 0.0f);
    const double build = seconds(start);
    const int cameraIndex = scene->findCamera(argc > 2 ? argv[2] : "");
    const studio::Camera camera = scene->cameraAt(cameraIndex, 0.0f);
    start = Clock::now();
    const studio::GBuffer g = studio::renderGBuffer(rays, camera, width, height, camera, 0.0f);
    const double gbuffer = seconds(start);

    std::size_t triangles = 0;
    for (const studio::Mesh& mesh : scene->meshes) triangles += mesh.triangles.size();
    fmt::print(
        "{}: {} triangles, {} meshes, {} materials, {} textures; load {:.2f} s, build {:.2f} s, "
        "G-buffer {}x{} {:.2f} s\n",
        scene->name, triangles, scene->meshes.size(), scene->materials.size(), scene->textures.size(),
        load, build, width, height, gbuffer);
    for (const studio::Camera& c : scene->cameras)
        fmt::print("  camera {}: ({}, {}, {}) fov {:.1f} deg aspect {}\n", c.name, c.position.x,
                   c.position.y, c.position.z, c.verticalFov * 180.0f / studio::kPi, c.aspect);
    for (const studio::Light& l : scene->lights)
        fmt::print(
            "  light {}: kind {} at ({}, {}, {}) along ({}, {}, {}) emits {} {} {} cone {:.1f} {:.1f} "
            "deg\n",
            l.name, int(l.kind), l.position.x, l.position.y, l.position.z, l.direction.x, l.direction.y,
            l.direction.z, l.emitted.x, l.emitted.y, l.emitted.z, l.innerCone * 180.0f / studio::kPi,
            l.outerCone * 180.0f / studio::kPi);
    for (const studio::Material& m : scene->materials)
        if (m.emission != glm::vec3(0.0f))
            fmt::print("  emitter {}: {} {} {}\n", m.name, m.emission.x, m.emission.y, m.emission.z);

    const std::string name = argc > 4 ? argv[4] : scene->name;
    for (std::size_t i = 0; i < scene->lights.size(); ++i) {
        studio::RsmOptions options;
        options.view = &g;
        start = Clock::now();
        const std::vector<studio::Rsm> rsms =
            studio::renderRsms(rays, scene->lightAt(int(i), 0.0f), options);
        double total = 0.0;
        for (const studio::Rsm& rsm : rsms)
            for (int y = 0; y < rsm.height; ++y)
                for (int x = 0; x < rsm.width; ++x) total += double(rsm.flux.row(1, y)[x]);
        const glm::mat4& p = rsms[0].projection;
        fmt::print(
            "  RSM {}^2 of {}: {:.2f} s, {} map(s), reflects {:.4g} W (green), P00 {:.4g} P11 {:.4g}\n",
            options.size, scene->lights[i].name, seconds(start), rsms.size(), total, p[0][0], p[1][1]);
        float brightest = 0.0f;
        for (int y = 0; y < rsms[0].height; ++y)
            for (int x = 0; x < rsms[0].width; ++x)
                brightest = std::max(brightest, rsms[0].flux.row(1, y)[x]);
        writeDisplay(fmt::format("{}.rsm{}.png", name, i), rsms[0].flux,
                     1.0f / std::max(brightest, 1e-30f));
    }
    const std::string prefix = argc > 4 ? argv[4] : scene->name;
    writeDisplay(prefix + ".albedo.png", g.albedo, 1.0f);
    writeDisplay(prefix + ".direct.png", g.direct, 0.5f);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 2;
    }
}
