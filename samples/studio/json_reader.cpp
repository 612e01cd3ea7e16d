// See json_reader.h.
#include "json_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

namespace studio {
namespace {

// Lists in lists deeper than this are not written out: dump() goes down them by calls, and a file may be
// as deep as it is long.
constexpr int kDeepest = 16;

bool isDeep(const nlohmann::json& json, int left = kDeepest) {
    return json.is_structured() &&
           (left == 0 || std::any_of(json.begin(), json.end(), [&](const nlohmann::json& item) {
                return isDeep(item, left - 1);
            }));
}

// Numbers without a fraction count as whole however they are written, as JSON Schema has it: 3.0.
bool isWhole(const nlohmann::json& json) {
    return json.is_number_integer() ||
           (json.is_number() && std::floor(json.get<double>()) == json.get<double>());
}

std::string shown(const nlohmann::json& json) {
    constexpr std::size_t kLongest = 60;
    if (isDeep(json)) return "lists in lists";
    std::string text = json.dump();
    return text.size() > kLongest ? text.substr(0, kLongest) + "..." : text;
}

std::string joined(const std::string& key, const std::string& name) {
    return key.empty() ? name : key + "." + name;
}

}  // namespace

void JsonValue::fail(const std::string& expected) const {
    throw std::runtime_error(fmt::format("{}: {}: expected {}, got {}", *file_,
                                         key_.empty() ? "the file" : key_, expected, shown(*json_)));
}

float JsonValue::number() const {
    if (!json_->is_number()) fail("a number");
    const float value = json_->get<float>();
    if (!std::isfinite(value)) fail("a number that a 32-bit float can hold");
    return value;
}

float JsonValue::number(float above, float upTo) const {
    const float value = number();
    if (!(value > above && value <= upTo))
        fail(fmt::format("a number above {} and at most {}", above, upTo));
    return value;
}

bool JsonValue::boolean() const {
    if (!json_->is_boolean()) fail("true or false");
    return json_->get<bool>();
}

int JsonValue::integer(int lowest, int highest) const {
    if (!isWhole(*json_) || json_->get<double>() < lowest || json_->get<double>() > highest)
        fail(fmt::format("a whole number {} .. {}", lowest, highest));
    return json_->get<int>();
}

std::uint32_t JsonValue::bits() const {
    constexpr const char* kExpected = "32 bits: a whole number 0 .. 4294967295, or a text as \"0xff\"";
    if (json_->is_number()) {
        const double value = json_->get<double>();
        if (!isWhole(*json_) || !(value >= 0.0 && value <= 4294967295.0)) fail(kExpected);
        return std::uint32_t(value);
    }
    if (!json_->is_string()) fail(kExpected);
    const std::string& text = json_->get_ref<const std::string&>();
    std::uint32_t value = 0;
    if (text.compare(0, 2, "0x") != 0) fail(kExpected);
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data() + 2, end, value, 16);
    if (read.ec != std::errc() || read.ptr != end) fail(kExpected);
    return value;
}

std::string JsonValue::text() const {
    if (!json_->is_string() || json_->get_ref<const std::string&>().empty()) fail("a text");
    return json_->get<std::string>();
}

glm::vec3 JsonValue::vector() const {
    if (!json_->is_array() || json_->size() != 3) fail("three numbers");
    const std::vector<JsonValue> items = list();
    return {items[0].number(), items[1].number(), items[2].number()};
}

glm::vec3 JsonValue::direction() const {
    const glm::vec3 v = vector();
    // In single precision where it can be: with one bit of a light another the truths that are kept of a
    // scene, named by what is in it, would be traced anew.
    const float length = glm::length(v);
    if (length > 1e-15f && length < 1e18f) return v / length;
    const glm::dvec3 extreme(v);  // squares of floats leave their range on both sides
    if (!(glm::length(extreme) > 0.0)) fail("a direction (not zero)");
    return glm::vec3(extreme / glm::length(extreme));
}

glm::vec3 JsonValue::colour() const {
    const glm::vec3 c = json_->is_number() ? glm::vec3(number()) : vector();
    if (c.x < 0.0f || c.y < 0.0f || c.z < 0.0f) fail("a colour (no negative number)");
    return c;
}

std::vector<JsonValue> JsonValue::list() const {
    if (!json_->is_array()) fail("a list");
    std::vector<JsonValue> items;
    for (std::size_t i = 0; i < json_->size(); ++i)
        items.emplace_back((*json_)[i], *file_, fmt::format("{}[{}]", key_, i));
    return items;
}

JsonObject JsonValue::object() const {
    if (!json_->is_object()) fail("an object");
    return JsonObject(*this, *json_);
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::members() const {
    if (!json_->is_object()) fail("an object");
    std::vector<std::pair<std::string, JsonValue>> items;
    for (const auto& item : json_->items())
        items.emplace_back(item.key(), JsonValue(item.value(), *file_, joined(key_, item.key())));
    return items;
}

std::optional<JsonValue> JsonObject::find(const std::string& name) {
    known_.insert(name);
    const auto it = json_->find(name);
    if (it == json_->end()) return std::nullopt;
    return JsonValue(*it, value_.file(), joined(value_.key(), name));
}

JsonValue JsonObject::need(const std::string& name, const std::string& expected) {
    if (std::optional<JsonValue> found = find(name)) return *found;
    throw std::runtime_error(fmt::format("{}: {}: expected {}, got nothing", value_.file(),
                                         joined(value_.key(), name), expected));
}

void JsonObject::finish() const {
    for (const auto& item : json_->items()) {
        if (known_.count(item.key()) != 0) continue;
        std::string names;
        for (const std::string& name : known_) names += (names.empty() ? "" : ", ") + name;
        throw std::runtime_error(fmt::format("{}: {}: unknown key; expected one of: {}", value_.file(),
                                             joined(value_.key(), item.key()), names));
    }
}

nlohmann::json readJsonFile(const std::string& path) {
    std::ifstream in(path);
    if (!in) throw std::runtime_error(fmt::format("{}: can't be read", path));
    std::vector<std::set<std::string>> keys;
    const auto refuseTwice = [&](int, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
        if (event == nlohmann::json::parse_event_t::object_start) keys.emplace_back();
        if (event == nlohmann::json::parse_event_t::object_end) keys.pop_back();
        if (event == nlohmann::json::parse_event_t::key &&
            !keys.back().insert(parsed.get<std::string>()).second)
            throw std::runtime_error(
                fmt::format("\"{}\": expected once in an object, got twice", parsed.get<std::string>()));
        return true;
    };
    try {
        return nlohmann::json::parse(in, refuseTwice);
    } catch (const std::exception& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
}

}  // namespace studio
