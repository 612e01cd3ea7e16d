// Checkpoints of the path tracer: a header, then Film::sums, in this machine's byte order.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>

#include "film.h"
#include "path_tracer.h"
#include "sampler.h"

namespace studio {
namespace {

struct Header {
    char magic[8];
    CheckpointKey key;
    std::uint64_t sums;
    std::uint32_t samples, halves;
};
constexpr char kMagic[8] = {'L', 'W', 'P', 'A', 'T', 'H', '0', '3'};

template <class T>
void hashValue(std::uint64_t& hash, const T& value) {
    static_assert(
        std::is_trivially_copyable<T>::value && std::has_unique_object_representations<T>::value,
        "padding would make hashes random");
    hash = hashBytes(&value, sizeof(T), hash);
}
void hashValue(std::uint64_t& hash, float value) {
    hash = hashBytes(&value, sizeof value, hash);
}
void hashValue(std::uint64_t& hash, const glm::vec3& v) {
    hash = hashBytes(&v, sizeof v, hash);
}
void hashValue(std::uint64_t& hash, const glm::mat4& m) {
    hash = hashBytes(&m, sizeof m, hash);
}

template <class T>
void hashArray(std::uint64_t& hash, const std::vector<T>& values) {
    hashValue(hash, values.size());
    hash = hashBytes(values.data(), values.size() * sizeof(T), hash);
}

}  // namespace

std::uint64_t hashBytes(const void* data, std::size_t bytes, std::uint64_t seed) {
    const char* at = static_cast<const char*>(data);
    std::uint64_t hash = seed ^ bytes;
    for (; bytes > 0;) {
        std::uint64_t word = 0;
        const std::size_t part = std::min(bytes, sizeof word);
        std::memcpy(&word, at, part);
        hash = mixBits(hash ^ word) + 0x9e3779b97f4a7c15u;
        at += part;
        bytes -= part;
    }
    return hash;
}

std::uint64_t hashScene(const RayScene& rayScene) {
    const Scene& scene = rayScene.scene();
    std::uint64_t hash = 1;
    for (const Texture& texture : scene.textures) {
        hashValue(hash, texture.width);
        hashArray(hash, texture.rgba);
    }
    for (const Material& material : scene.materials) {
        hashValue(hash, material.albedo);
        hashValue(hash, material.emission);
        hashValue(hash, material.texture);
        hashValue(hash, material.alphaCutoff);
    }
    for (const Mesh& mesh : scene.meshes) {
        hashValue(hash, mesh.material);
        hashValue(hash, scene.objects[std::size_t(mesh.object)].poseAt(rayScene.time()));
        hashArray(hash, mesh.positions);
        hashArray(hash, mesh.normals);
        hashArray(hash, mesh.uvs);
        hashArray(hash, mesh.triangles);
    }
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        const Light light = scene.lightAt(int(i), rayScene.time());
        hashValue(hash, int(light.kind));
        hashValue(hash, light.position);
        hashValue(hash, light.direction);
        hashValue(hash, light.emitted);
        hashValue(hash, light.innerCone);
        hashValue(hash, light.outerCone);
    }
    hashValue(hash, scene.sky);
    hashValue(hash, int(scene.emissiveSurfaces));
    return hash;
}

std::uint64_t hashView(const GBuffer& gbuffer) {
    std::uint64_t hash = 2;
    hashValue(hash, gbuffer.width);
    hashValue(hash, gbuffer.height);
    hashValue(hash, gbuffer.camera.position);
    for (int plane = 0; plane < 3; ++plane)
        for (int y = 0; y < gbuffer.height; ++y) {
            const std::size_t bytes = std::size_t(gbuffer.width) * sizeof(float);
            hash = hashBytes(gbuffer.position.row(plane, y), bytes, hash);
            hash = hashBytes(gbuffer.normal.row(plane, y), bytes, hash);
        }
    return hash;
}

void saveCheckpoint(const std::string& path, const CheckpointKey& key, const Film& film) {
    Header header{};
    std::memcpy(header.magic, kMagic, sizeof kMagic);
    header.key = key;
    header.sums = film.sums.size();
    header.samples = film.samples;
    header.halves = std::uint32_t(film.halves);

    const std::string unfinished = path + ".part";
    std::ofstream file(unfinished, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(&header), sizeof header);
    file.write(reinterpret_cast<const char*>(film.sums.data()),
               std::streamsize(film.sums.size() * sizeof film.sums[0]));
    file.close();
    if (!file) throw std::runtime_error(fmt::format("checkpoint \"{}\": cannot be written", unfinished));
    std::error_code error;
    std::filesystem::rename(unfinished, path, error);
    if (error) throw std::runtime_error(fmt::format("checkpoint \"{}\": {}", path, error.message()));
}

bool loadCheckpoint(const std::string& path, const CheckpointKey& key, Film& film) {
    if (!std::filesystem::exists(path)) return false;
    const auto refuse = [&](const std::string& reason) {
        throw CheckpointError(fmt::format("checkpoint \"{}\": {}", path, reason));
    };
    std::ifstream file(path, std::ios::binary);
    Header header{};
    file.read(reinterpret_cast<char*>(&header), sizeof header);
    if (!file || std::memcmp(header.magic, kMagic, sizeof kMagic) != 0)
        refuse("expected a path tracer's checkpoint, found another kind of file");

    // The order tells the likeliest mistake first.
    if (header.key.options != key.options)
        refuse(
            "belongs to a run with other options (seed, bounces, unshadowed, senders seen, ambient "
            "occlusion or VPLs)");
    if (header.key.scene != key.scene) refuse("belongs to another scene or to other lights");
    if (header.key.view != key.view) refuse("belongs to another camera or size");
    if (header.sums != film.sums.size() || header.halves != std::uint32_t(film.halves))
        refuse("holds another number of layers");

    std::vector<glm::dvec3> sums(film.sums.size());
    file.read(reinterpret_cast<char*>(sums.data()), std::streamsize(sums.size() * sizeof sums[0]));
    if (!file || file.peek() != std::ifstream::traits_type::eof())
        refuse("is cut short or has data after its end");
    film.sums.swap(sums);
    film.samples = header.samples;
    return true;
}

}  // namespace studio
