// Virtual point lights: their light on a surface, a shadow ray each, and the text file they travel in.
//
// Source: bounded term from the point-to-disc form factor, exact on the disc's axis (docs: the rsm
// technique's page). Visibility is that of the VPL's centre: one ray for each pair.
#include "vpl_visibility.h"

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

namespace studio {
namespace {

// Rays end short of the VPL by this share of their length, beyond the offset off its surface.
constexpr float kShort = 1e-5f;
constexpr const char* kTitle = "lightwell-vpls";

}  // namespace

glm::dvec3 vplIrradiance(const VplRecord& vpl, const Surface& at) {
    const glm::dvec3 towards = glm::dvec3(vpl.position) - glm::dvec3(at.position);
    const double distance2 = glm::dot(towards, towards);
    if (distance2 <= 0.0) return glm::dvec3(0.0);  // the surface is the VPL, and never lights itself
    const double distance = std::sqrt(distance2);
    const double cosine = glm::dot(glm::dvec3(at.normal), towards) / distance;
    const double vplCosine = -glm::dot(glm::dvec3(vpl.normal), towards) / distance;
    if (cosine <= 0.0 || vplCosine <= 0.0) return glm::dvec3(0.0);
    constexpr double pi = 3.14159265358979323846;
    return glm::dvec3(vpl.flux) * (vplCosine * cosine /
                                  (pi * distance2 + 0.25 * (1.0 + 3.0 * vplCosine * vplCosine) * double(vpl.area)));
}

bool vplVisible(const RayScene& scene, const VplRecord& vpl, const Surface& at) {
    const glm::vec3 origin = scene.offset(at.position, at.geometricNormal);
    const glm::vec3 towards = scene.offset(vpl.position, vpl.normal) - origin;
    const float distance = glm::length(towards);
    if (!(distance > 0.0f)) return true;
    const glm::vec3 direction = towards / distance;
    if (glm::dot(at.geometricNormal, direction) <= 0.0f) return false;  // behind the surface's own body
    return !scene.occluded(origin, direction, 0.0f, distance * (1.0f - kShort));
}

void writeVpls(const std::string& path, const std::vector<VplRecord>& vpls) {
    std::ofstream file(path);
    file << kTitle << " 1 " << vpls.size() << '\n';
    for (const VplRecord& v : vpls)
        file << fmt::format("{:.9g} {:.9g} {:.9g}  {:.9g} {:.9g} {:.9g}  {:.9g} {:.9g} {:.9g}  {:.9g}\n",
                            v.position.x, v.position.y, v.position.z, v.normal.x, v.normal.y, v.normal.z,
                            v.flux.x, v.flux.y, v.flux.z, v.area);
    file.close();
    if (!file) throw std::runtime_error(fmt::format("VPL file \"{}\": cannot be written", path));
}

std::vector<VplRecord> readVpls(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(fmt::format("VPL file \"{}\": cannot be opened", path));
    const auto refuse = [&](std::size_t line, const std::string& expected, const std::string& came) {
        throw std::runtime_error(fmt::format("VPL file \"{}\", line {}: expected {}, got \"{}\"", path,
                                             line, expected, came));
    };

    std::string line, title, rest;
    int version = 0;
    std::size_t count = 0;
    std::getline(file, line);
    std::istringstream header(line);
    if (!(header >> title >> version >> count) || title != kTitle || version != 1 || (header >> rest))
        refuse(1, fmt::format("\"{} 1 COUNT\"", kTitle), line);

    std::vector<VplRecord> vpls;
    while (vpls.size() < count) {
        const std::size_t number = vpls.size() + 2;
        if (!std::getline(file, line)) refuse(number, fmt::format("{} VPLs", count), "end of file");
        std::istringstream in(line);
        VplRecord v;
        in >> v.position.x >> v.position.y >> v.position.z >> v.normal.x >> v.normal.y >> v.normal.z >>
            v.flux.x >> v.flux.y >> v.flux.z >> v.area;
        if (!in || (in >> rest)) refuse(number, "ten finite numbers", line);
        if (v.area < 0.0f) refuse(number, "an area of at least 0", line);
        if (std::abs(glm::length(v.normal) - 1.0f) > 1e-3f) refuse(number, "a unit normal", line);
        vpls.push_back(v);
    }
    while (std::getline(file, line))
        if (!line.empty()) refuse(count + 2, "nothing more", line);
    return vpls;
}

}  // namespace studio
