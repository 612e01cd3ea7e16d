// See static_vpls.h.
#include "static_vpls.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "json_reader.h"

namespace studio {
namespace {

constexpr const char* kFormat = "lightwell-static-vpls";
constexpr int kVersion = 1;
// A normal this near to unit length is taken as it is, so that writing and reading changes no bit; a
// few roundings of a float's 6e-8 stay far below it.
constexpr float kUnitTolerance = 1e-6f;

float readPositive(const JsonValue& value) {
    const float number = value.number();
    if (!(number > 0.0f)) value.fail("a number above 0");
    return number;
}

glm::vec3 readReflectance(const JsonValue& value) {
    const glm::vec3 rho = value.colour();
    if (rho.x > 1.0f || rho.y > 1.0f || rho.z > 1.0f) value.fail("reflectances 0 .. 1");
    return rho;
}

glm::vec3 readNormal(const JsonValue& value) {
    const glm::vec3 given = value.vector(), unit = value.direction();
    return std::abs(glm::length(given) - 1.0f) <= kUnitTolerance ? given : unit;
}

std::string readText(JsonObject& o, const char* key) {
    const auto found = o.find(key);
    return found ? found->text() : "";
}

// 0 would be a VPL for nobody.
std::uint32_t readMask(const JsonValue& value) {
    const std::uint32_t mask = value.bits();
    if (mask == 0) value.fail("at least one bit");
    return mask;
}

StaticVpl readVpl(const JsonValue& value) {
    JsonObject o = value.object();
    StaticVpl vpl;
    vpl.name = readText(o, "name");
    vpl.object = readText(o, "object");
    vpl.position = o.need("position", "three numbers").vector();
    vpl.normal = readNormal(o.need("normal", "a direction"));
    vpl.reflectance = readReflectance(o.need("reflectance", "reflectances 0 .. 1"));
    if (const auto weight = o.find("weight")) vpl.weight = readPositive(*weight);
    if (const auto mask = o.find("light_mask")) vpl.lightMask = readMask(*mask);
    if (const auto mask = o.find("receiver_mask")) vpl.receiverMask = readMask(*mask);
    if (const auto population = o.find("population")) vpl.population = population->bits();
    o.finish();
    return vpl;
}

StaticBlocker readBlocker(const JsonValue& value) {
    JsonObject o = value.object();
    StaticBlocker blocker;
    blocker.name = readText(o, "name");
    blocker.object = readText(o, "object");
    blocker.center = o.need("center", "three numbers").vector();
    blocker.radius = readPositive(o.need("radius", "a number above 0"));
    o.finish();
    return blocker;
}

StaticVpls readDocument(const JsonValue& root) {
    JsonObject o = root.object();
    const JsonValue format = o.need("format", fmt::format("\"{}\"", kFormat));
    if (format.text() != kFormat) format.fail(fmt::format("\"{}\"", kFormat));
    o.need("version", fmt::format("{}", kVersion)).integer(kVersion, kVersion);
    StaticVpls all;
    if (const auto unit = o.find("metres_per_unit")) all.metresPerUnit = readPositive(*unit);
    if (const auto area = o.find("area_per_weight")) all.areaPerWeight = readPositive(*area);
    const JsonValue vpls = o.need("vpls", "a list of VPLs");
    for (const JsonValue& item : vpls.list()) all.vpls.push_back(readVpl(item));
    if (all.vpls.size() > kMostStaticVpls) vpls.fail(fmt::format("at most {} VPLs", kMostStaticVpls));
    if (const auto blockers = o.find("blockers")) {
        for (const JsonValue& item : blockers->list()) all.blockers.push_back(readBlocker(item));
        if (all.blockers.size() > kMostStaticBlockers)
            blockers->fail(fmt::format("at most {} blockers", kMostStaticBlockers));
    }
    o.finish();
    return all;
}

// The fewest digits that read back as the same float, through a double as JSON readers have it.
std::string exact(float value) {
    if (!std::isfinite(value))
        throw std::invalid_argument(fmt::format("static VPLs: expected finite numbers, got {}", value));
    for (int digits = 1; digits < 9; ++digits) {
        const std::string text = fmt::format("{:.{}g}", value, digits);
        if (float(std::strtod(text.c_str(), nullptr)) == value) return text;
    }
    return fmt::format("{:.9g}", value);
}

std::string exact(const glm::vec3& v) {
    return fmt::format("[{}, {}, {}]", exact(v.x), exact(v.y), exact(v.z));
}

std::string labels(const std::string& name, const std::string& object) {
    std::string text;
    if (!name.empty()) text += fmt::format("\"name\": {}, ", nlohmann::json(name).dump());
    if (!object.empty()) text += fmt::format("\"object\": {}, ", nlohmann::json(object).dump());
    return text;
}

std::string written(const StaticVpl& v) {
    std::string text = fmt::format(R"({{{}"position": {}, "normal": {}, "reflectance": {})",
                                   labels(v.name, v.object), exact(v.position), exact(v.normal),
                                   exact(v.reflectance));
    if (v.weight) text += fmt::format(", \"weight\": {}", exact(*v.weight));
    if (v.lightMask != ~0u) text += fmt::format(", \"light_mask\": \"{:#x}\"", v.lightMask);
    if (v.receiverMask != ~0u) text += fmt::format(", \"receiver_mask\": \"{:#x}\"", v.receiverMask);
    if (v.population != 0) text += fmt::format(", \"population\": {}", v.population);
    return text + "}";
}

std::string written(const StaticBlocker& b) {
    return fmt::format(R"({{{}"center": {}, "radius": {}}})", labels(b.name, b.object), exact(b.center),
                       exact(b.radius));
}

// One item a line, which is what hands and diffs want.
template <class T>
std::string list(const std::vector<T>& items) {
    std::string text = "[";
    for (std::size_t i = 0; i < items.size(); ++i)
        text += (i == 0 ? "\n    " : ",\n    ") + written(items[i]);
    return text + (items.empty() ? "]" : "\n  ]");
}

glm::mat4 poseOf(const Scene& scene, const std::string& object, float time) {
    if (object.empty()) return glm::mat4(1.0f);
    std::string names;
    for (std::size_t i = 1; i < scene.objects.size(); ++i) {
        if (scene.objects[i].name == object) return scene.objects[i].poseAt(time);
        names += (i == 1 ? "" : ", ") + scene.objects[i].name;
    }
    throw std::runtime_error(fmt::format("static VPLs: object \"{}\": expected one of scene {}: {}", object,
                                         scene.name, names.empty() ? "(it has none)" : names));
}

}  // namespace

StaticVpls readStaticVpls(const std::string& path) {
    const nlohmann::json document = readJsonFile(path);
    return readDocument(JsonValue(document, path, ""));
}

void writeStaticVpls(const std::string& path, const StaticVpls& all) {
    const std::string text = fmt::format(
        "{{\n  \"format\": \"{}\",\n  \"version\": {},\n  \"metres_per_unit\": {},\n"
        "  \"area_per_weight\": {},\n  \"vpls\": {},\n  \"blockers\": {}\n}}\n",
        kFormat, kVersion, exact(all.metresPerUnit), exact(all.areaPerWeight), list(all.vpls),
        list(all.blockers));
    std::ofstream file(path);
    file << text;
    file.close();
    if (!file) throw std::runtime_error(fmt::format("{}: can't be written", path));
}

StaticVpls posedVpls(const StaticVpls& all, const Scene& scene, float time) {
    StaticVpls posed = all;
    const float unit = all.metresPerUnit;
    posed.metresPerUnit = 1.0f;
    posed.areaPerWeight = all.areaPerWeight * unit * unit;
    for (StaticVpl& vpl : posed.vpls) {
        vpl.position *= unit;
        if (vpl.object.empty()) continue;
        const glm::mat4 pose = poseOf(scene, vpl.object, time);
        vpl.position = glm::vec3(pose * glm::vec4(vpl.position, 1.0f));
        vpl.normal = glm::normalize(glm::vec3(pose * glm::vec4(vpl.normal, 0.0f)));
        vpl.object.clear();
    }
    for (StaticBlocker& blocker : posed.blockers) {
        blocker.center *= unit;
        blocker.radius *= unit;
        if (blocker.object.empty()) continue;
        blocker.center =
            glm::vec3(poseOf(scene, blocker.object, time) * glm::vec4(blocker.center, 1.0f));
        blocker.object.clear();
    }
    return posed;
}

void fillWeights(StaticVpls& all) {
    for (std::size_t i = 0; i < all.vpls.size(); ++i) {
        if (all.vpls[i].weight) continue;
        if (all.vpls.size() < 2)
            throw std::runtime_error(
                "static VPLs: vpls[0].weight: expected a weight, or another VPL to take it from");
        double nearest2 = std::numeric_limits<double>::infinity();
        for (std::size_t j = 0; j < all.vpls.size(); ++j) {
            const glm::dvec3 way = glm::dvec3(all.vpls[j].position) - glm::dvec3(all.vpls[i].position);
            if (j != i) nearest2 = std::min(nearest2, glm::dot(way, way));
        }
        all.vpls[i].weight = float(0.25 * double(kPi) * nearest2 / double(all.areaPerWeight));
    }
}

}  // namespace studio
