// Strict reading of JSON: every error names the file, the key, what was expected and what came, and
// keys that nobody asked for are errors.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

namespace studio {

class JsonObject;

// A value and its place, "cameras[0].position". Refers to the document, which must outlive it.
class JsonValue {
public:
    JsonValue(const nlohmann::json& json, const std::string& file, std::string key)
        : json_(&json), file_(&file), key_(std::move(key)) {}

    const std::string& file() const { return *file_; }
    const std::string& key() const { return key_; }
    [[noreturn]] void fail(const std::string& expected) const;

    float number() const;
    float number(float above, float upTo) const;  // in (above, upTo]
    bool boolean() const;
    int integer(int lowest, int highest) const;
    std::uint32_t bits() const;  // a whole number of 32 bits, or the same as text, "0xff"
    std::string text() const;
    glm::vec3 vector() const;     // three numbers
    glm::vec3 direction() const;  // three numbers, not all zero; returned as unit vector
    glm::vec3 colour() const;     // three numbers, or one for all; none negative
    std::vector<JsonValue> list() const;
    JsonObject object() const;
    std::vector<std::pair<std::string, JsonValue>> members() const;  // of an object of any keys

private:
    const nlohmann::json* json_;
    const std::string* file_;
    std::string key_;
};

// An object of known keys; call finish() when all of them have been asked for.
class JsonObject {
public:
    explicit JsonObject(const JsonValue& value, const nlohmann::json& json)
        : value_(value), json_(&json) {}
    std::optional<JsonValue> find(const std::string& name);
    JsonValue need(const std::string& name, const std::string& expected);
    const JsonValue& value() const { return value_; }
    void finish() const;

private:
    JsonValue value_;
    const nlohmann::json* json_;
    std::set<std::string> known_;
};

// The document in a file, with no key twice in one object (a slip of a hand's; of two values the last would count). std::runtime_error
// naming the path.
nlohmann::json readJsonFile(const std::string& path);

}  // namespace studio
