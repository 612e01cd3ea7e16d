// The file of static VPLs: what is written reads back bit for bit, what is wrong is named, and poses, units and
// automatic weights by hand.
#include <unistd.h>

#include <catch2/catch.hpp>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "sampler.h"
#include "scene.h"
#include "static_vpls.h"

namespace {

using namespace studio;
namespace fs = std::filesystem;

struct File {
    fs::path path = fs::temp_directory_path() / ("static_vpls_test_" + std::to_string(::getpid()) + ".json");
    ~File() { fs::remove(path); }
    std::string name() const { return path.string(); }
    const File& write(const std::string& text) const {
        std::ofstream(path) << text;
        return *this;
    }
};

bool sameBits(float a, float b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}
bool sameBits(const glm::vec3& a, const glm::vec3& b) {
    return sameBits(a.x, b.x) && sameBits(a.y, b.y) && sameBits(a.z, b.z);
}

// Any finite float: sign, exponent and fraction by chance.
float anyFloat(Sampler& sampler, int lowestExponent, int highestExponent) {
    const glm::dvec2 p = sampler.nextFine(), q = sampler.nextFine();
    const double exponent = lowestExponent + std::floor(q.x * (highestExponent - lowestExponent + 1));
    return float(std::ldexp(1.0 + p.x, int(exponent)) * (q.y < 0.5 ? -1.0 : 1.0));
}

StaticVpls someVpls(int count) {
    StaticVpls all;
    all.metresPerUnit = 0.0254f;
    all.areaPerWeight = 1.0f / 3.0f;
    Sampler sampler(7, 1, 0);
    for (int i = 0; i < count; ++i) {
        StaticVpl v;
        v.position = {anyFloat(sampler, -149, 29), anyFloat(sampler, -20, 10), anyFloat(sampler, -3, 3)};
        v.normal = glm::normalize(glm::vec3(anyFloat(sampler, -2, 1), anyFloat(sampler, -9, 1), 0.3f));
        v.reflectance = {sampler.next().x, sampler.next().y, i == 0 ? 1.0f : 0.0f};
        if (i % 3 != 0) v.weight = std::abs(anyFloat(sampler, -30, 59));
        if (i % 2 != 0) v.lightMask = 0x80000001u, v.receiverMask = 2u;
        v.population = std::uint32_t(i % 5);
        if (i % 4 == 0) v.name = "a \"name\" with \\ and \xc3\xa4";
        if (i % 7 == 0) v.object = "door";
        all.vpls.push_back(v);
        if (i % 10 == 0) all.blockers.push_back({v.position, std::abs(v.position.y), v.name, v.object});
    }
    return all;
}

constexpr const char* kHead = R"({"format": "lightwell-static-vpls", "version": 1, "vpls": [)";
constexpr const char* kVpl = R"({"position": [0, 1, 2], "normal": [0, 2, 0], "reflectance": 0.5)";

}  // namespace

TEST_CASE("static VPLs read back bit for bit") {
    const File file;
    const StaticVpls all = someVpls(300);
    writeStaticVpls(file.name(), all);
    const StaticVpls back = readStaticVpls(file.name());
    CHECK(sameBits(back.metresPerUnit, all.metresPerUnit));
    CHECK(sameBits(back.areaPerWeight, all.areaPerWeight));
    REQUIRE(back.vpls.size() == all.vpls.size());
    REQUIRE(back.blockers.size() == all.blockers.size());
    for (std::size_t i = 0; i < all.vpls.size(); ++i) {
        const StaticVpl &a = all.vpls[i], &b = back.vpls[i];
        CAPTURE(i);
        REQUIRE(sameBits(a.position, b.position));
        REQUIRE(sameBits(a.normal, b.normal));
        REQUIRE(sameBits(a.reflectance, b.reflectance));
        REQUIRE(a.weight.has_value() == b.weight.has_value());
        if (a.weight) REQUIRE(sameBits(*a.weight, *b.weight));
        REQUIRE(a.lightMask == b.lightMask);
        REQUIRE(a.receiverMask == b.receiverMask);
        REQUIRE(a.population == b.population);
        REQUIRE(a.name == b.name);
        REQUIRE(a.object == b.object);
    }
    for (std::size_t i = 0; i < all.blockers.size(); ++i) {
        REQUIRE(sameBits(all.blockers[i].center, back.blockers[i].center));
        REQUIRE(sameBits(all.blockers[i].radius, back.blockers[i].radius));
    }
}

TEST_CASE("a hand's file: defaults, one reflectance for all, masks in both forms, any length of normal") {
    const File file;
    file.write(std::string(kHead) + kVpl + R"(, "light_mask": 5, "receiver_mask": "0xFFFFFFFE", "weight": 0.25}],)"
                                    R"("blockers": [{"center": [1, 1, 1], "radius": 0.5}]})");
    const StaticVpls all = readStaticVpls(file.name());
    REQUIRE(all.vpls.size() == 1);
    CHECK(all.vpls[0].normal == glm::vec3(0, 1, 0));
    CHECK(all.vpls[0].reflectance == glm::vec3(0.5f));
    CHECK(all.vpls[0].lightMask == 5u);
    CHECK(all.vpls[0].receiverMask == 0xfffffffeu);
    CHECK(all.vpls[0].weight == 0.25f);
    CHECK(all.vpls[0].population == 0u);
    CHECK(all.metresPerUnit == 1.0f);
    CHECK(all.areaPerWeight == 1.0f);
    CHECK(all.blockers[0].radius == 0.5f);
}

TEST_CASE("what is wrong with a file of static VPLs is named") {
    const File file;
    const auto refused = [&](const std::string& text, const std::string& key, const std::string& expected) {
        CAPTURE(text.substr(0, 200));
        file.write(text);
        CHECK_THROWS_WITH(readStaticVpls(file.name()), Catch::Contains(file.name()) && Catch::Contains(key) &&
                                                           Catch::Contains("expected " + expected));
    };
    const auto ofVpl = [&](const std::string& more, const std::string& key, const std::string& expected) {
        refused(std::string(kHead) + kVpl + more + "}]}", "vpls[0]" + key, expected);
    };
    refused(R"({"version": 1, "vpls": []})", "format", "\"lightwell-static-vpls\"");
    refused(R"({"format": "gltf", "version": 1, "vpls": []})", "format", "\"lightwell-static-vpls\", got");
    refused(R"({"format": "lightwell-static-vpls", "version": 2, "vpls": []})", "version", "a whole number 1 .. 1");
    refused(R"({"format": "lightwell-static-vpls", "version": 1})", "vpls", "a list of VPLs, got nothing");
    refused(R"({"format": "lightwell-static-vpls", "version": 1, "vpls": [], "metres_per_unit": 0})",
            "metres_per_unit", "a number above 0, got 0");
    refused(std::string(kHead) + R"({"normal": [0, 1, 0], "reflectance": 1}]})", "vpls[0].position", "three numbers");
    refused(std::string(kHead) + R"({"position": [0, 1, 0], "normal": [0, 0, 0], "reflectance": 1}]})",
            "vpls[0].normal", "a direction");
    refused(std::string(kHead) + R"({"position": [0, 1, 0], "normal": [0, 1, 0], "reflectance": [0, 1.5, 0]}]})",
            "vpls[0].reflectance", "reflectances 0 .. 1");
    ofVpl(R"(, "weight": 0)", ".weight", "a number above 0, got 0");
    ofVpl(R"(, "light_mask": 0)", ".light_mask", "at least one bit, got 0");
    ofVpl(R"(, "receiver_mask": "0x0")", ".receiver_mask", "at least one bit");
    ofVpl(R"(, "light_mask": 4294967296)", ".light_mask", "32 bits");
    ofVpl(R"(, "light_mask": "0x100000000")", ".light_mask", "32 bits");
    ofVpl(R"(, "light_mask": "12")", ".light_mask", "32 bits");
    ofVpl(R"(, "receiver_mask": 1.5)", ".receiver_mask", "32 bits");
    ofVpl(R"(, "name": "")", ".name", "a text");
    ofVpl(R"(, "wieght": 1)", ".wieght: unknown key;", "one of");
    refused(std::string(kHead) + kVpl + R"(, "weight": 1, "weight": 2}]})", "\"weight\"", "once in an object, got twice");
    ofVpl(R"(, "light_mask": -1)", ".light_mask", "32 bits");
    // However deep: neither reading nor telling goes down by calls.
    const std::string deep = std::string(1000000, '[') + std::string(1000000, ']');
    refused(deep, "the file", "an object, got lists in lists");
    refused("{\"format\": " + deep + "}", "format", "a text, got lists in lists");
    refused(std::string(kHead) + R"(], "blockers": [{"center": [0, 0, 0], "radius": 0}]})", "blockers[0].radius",
            "a number above 0");
    std::string many = kHead;
    for (int i = 0; i <= 4096; ++i) many += (i == 0 ? "" : ",") + std::string(kVpl) + "}";
    refused(many + "]}", "vpls", "at most 4096 VPLs");
    file.write("{");
    CHECK_THROWS_WITH(readStaticVpls(file.name()), Catch::Contains(file.name()));
    CHECK_THROWS_WITH(readStaticVpls("/no/such/file.json"), Catch::Contains("/no/such/file.json"));
}

TEST_CASE("normals of any length that floats hold, and whole numbers however they are written") {
    const File file;
    const StaticVpls all = readStaticVpls(
        file.write(R"({"format": "lightwell-static-vpls", "version": 1.0, "vpls": [
            {"position": [0, 0, 0], "normal": [3e38, 3e38, 0], "reflectance": 1, "population": 5.0, "light_mask": 255.0},
            {"position": [0, 0, 0], "normal": [0, 0, 1e-44], "reflectance": 1}]})")
            .name());
    REQUIRE(all.vpls.size() == 2);
    CHECK(all.vpls[0].normal.x == Approx(std::sqrt(0.5)));
    CHECK(all.vpls[0].normal.y == Approx(std::sqrt(0.5)));
    CHECK(all.vpls[0].population == 5);
    CHECK(all.vpls[0].lightMask == 255u);
    CHECK(all.vpls[1].normal.z == 1.0f);
}

TEST_CASE("units and automatic weights: inches, and discs that reach half-way to the nearest") {
    StaticVpls all;
    all.metresPerUnit = 0.0254f;
    all.areaPerWeight = 2.0f;
    for (const float x : {0.0f, 100.0f, 140.0f}) {
        StaticVpl v;
        v.position = {x, 0, 0};
        all.vpls.push_back(v);
    }
    all.vpls[0].weight = 3.0f;
    all.blockers.push_back({{10, 0, 0}, 5.0f, "", ""});
    StaticVpls posed = posedVpls(all, Scene{}, 0.0f);
    CHECK_FALSE(posed.vpls[1].weight.has_value());  // a technique may have its own way
    fillWeights(posed);
    CHECK(posed.metresPerUnit == 1.0f);
    CHECK(double(posed.areaPerWeight) == Approx(2.0 * 0.0254 * 0.0254));
    CHECK(posed.vpls[0].weight == 3.0f);
    const double disc = 3.14159265358979 * 20.0 * 20.0;  // inches^2: 40 inches to the third
    CHECK(double(*posed.vpls[1].weight) == Approx(disc / 2.0));
    CHECK(double(*posed.vpls[2].weight) == Approx(disc / 2.0));
    CHECK(double(posed.vpls[1].position.x) == Approx(2.54));
    CHECK(double(posed.blockers[0].radius) == Approx(0.127));

    all.vpls.resize(1);
    all.vpls[0].weight.reset();
    CHECK_THROWS_WITH(fillWeights(all), Catch::Contains("weight"));
}

TEST_CASE("VPLs and blockers of an object move with it") {
    Scene scene;
    Object door;
    door.name = "door";
    door.keys = {{0.0f, {1, 0, 0}, glm::quat(1, 0, 0, 0)},
                 {1.0f, {1, 0, 0}, glm::angleAxis(kPi / 2.0f, glm::vec3(0, 1, 0))}};
    scene.objects.push_back(door);
    StaticVpls all;
    StaticVpl v;
    v.position = {0, 0, 2}, v.normal = {0, 0, 1}, v.weight = 1.0f, v.object = "door";
    all.vpls = {v};
    all.blockers = {{{0, 1, 0}, 1.0f, "", "door"}};
    const StaticVpls posed = posedVpls(all, scene, 1.0f);  // z turns to x
    CHECK(glm::length(posed.vpls[0].position - glm::vec3(3, 0, 0)) < 1e-6f);
    CHECK(glm::length(posed.vpls[0].normal - glm::vec3(1, 0, 0)) < 1e-6f);
    CHECK(glm::length(posed.blockers[0].center - glm::vec3(1, 1, 0)) < 1e-6f);
    CHECK(posed.vpls[0].object.empty());
    all.vpls[0].object = "window";
    CHECK_THROWS_WITH(posedVpls(all, scene, 0.0f), Catch::Contains("window") && Catch::Contains("door"));
}
