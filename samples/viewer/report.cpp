#include "report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "image.h"

namespace viewer {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kLightwellStage = "lightwell";

std::vector<float> readTexture(const Texture& texture, GLenum format, std::size_t channels) {
    std::vector<float> values(std::size_t(texture.width()) * std::size_t(texture.height()) * channels * std::size_t(std::max(1, texture.layers())));
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    texture.bind(0);
    glGetTexImage(texture.target(), 0, format, GL_FLOAT, values.data());
    return values;
}

void addLayer(studio::Image& image, const std::string& prefix, const Texture& texture, bool isEncoded) {
    const std::vector<float> rgb = readTexture(texture, GL_RGB, 3);
    const char* const names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<float>& plane = image.plane(prefix + names[c]);
        for (std::size_t i = 0; i < plane.size(); ++i)
            plane[i] = isEncoded ? studio::srgbDecode(std::clamp(rgb[3 * i + c], 0.0f, 1.0f)) : rgb[3 * i + c];
    }
}

double medianWall(const std::vector<IndirectFigures>& frames, bool isDevice) {
    std::vector<double> values;
    for (const IndirectFigures& frame : frames) values.push_back(isDevice ? frame.deviceMilliseconds : frame.wallMilliseconds);
    return medianOf(values);
}

// Medians of passes by name; a pass that a frame runs twice counts with its sum.
std::vector<PassTime> medianPasses(const std::vector<IndirectFigures>& frames) {
    std::vector<PassTime> passes;
    if (frames.empty()) return passes;
    const auto sumOf = [](const IndirectFigures& frame, const std::string& name) {
        double sum = 0.0;
        for (const PassTime& pass : frame.passes)
            if (pass.name == name) sum += pass.milliseconds;
        return sum;
    };
    for (const PassTime& pass : frames.back().passes) {
        if (std::any_of(passes.begin(), passes.end(), [&](const PassTime& known) { return known.name == pass.name; })) continue;
        std::vector<double> values;
        for (const IndirectFigures& frame : frames) values.push_back(sumOf(frame, pass.name));
        passes.push_back({pass.name, medianOf(values)});
    }
    return passes;
}

Json stagesJson(const Report& report, double& host) {
    Json stages = Json::object();
    host = 0.0;
    for (const auto& [name, milliseconds] : report.timings->stages()) {
        if (name == kLightwellStage) continue;
        stages[name] = milliseconds;
        host += milliseconds;
    }
    return stages;
}

Json indirectJson(const Report& report) {
    Json json;
    const LWDeviceInfo& device = report.indirect->deviceInfo();
    json["device"] = device.name;
    json["platform"] = device.platform;
    json["technique"] = report.indirect->settings().technique;
    json["settings"] = report.indirect->settings().text();
    json["ms"] = medianWall(*report.indirectFrames, false);
    const double onDevice = medianWall(*report.indirectFrames, true);
    json["device_ms"] = onDevice < 0.0 ? Json() : Json(onDevice);
    Json passes = Json::array();
    for (const PassTime& pass : medianPasses(*report.indirectFrames))
        passes.push_back({{"name", pass.name}, {"ms", pass.milliseconds < 0.0 ? Json() : Json(pass.milliseconds)}});
    json["passes"] = passes;
    const IndirectFigures& last = report.indirectFrames->back();
    for (const auto& [name, reason] : last.choices) json["choices"][name] = reason;
    for (const auto& [name, count] : last.counts) json["counts"][name] = count;
    json["bytes"] = {{"device", last.deviceBytes}, {"host_copies", last.hostCopyBytes}};
    json["sharing"] = report.indirect->sharing();
    return json;
}

Json rsmsJson(const Report& report) {
    Json rsms = Json::array();
    for (const RsmSum& rsm : report.rsms)
        rsms.push_back({{"light", rsm.light}, {"size", rsm.size}, {"lit_texels", rsm.litTexels}, {"flux", {rsm.flux.x, rsm.flux.y, rsm.flux.z}}});
    return rsms;
}

Json findingsJson(const Report& report) {
    Json findings = Json::array();
    for (const LWInputFinding& finding : *report.findings)
        findings.push_back({{"severity", int(finding.severity)}, {"argument", finding.argument}, {"message", finding.message}});
    return findings;
}

}  // namespace

RsmSum sumRsm(const std::string& light, const RsmImages& rsm) {
    RsmSum sum;
    sum.light = light;
    sum.size = rsm.flux.width();
    const std::vector<float> flux = readTexture(rsm.flux, GL_RGB, 3);
    for (std::size_t i = 0; i < flux.size(); i += 3) {
        const glm::dvec3 texel(flux[i], flux[i + 1], flux[i + 2]);
        sum.flux += texel;
        if (texel != glm::dvec3(0.0)) ++sum.litTexels;
    }
    return sum;
}

void writeScreen(const std::string& file, GLuint framebuffer, int width, int height) {
    std::vector<std::uint8_t> rgb(std::size_t(width) * std::size_t(height) * 3);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glReadBuffer(framebuffer == 0 ? GL_BACK : GL_COLOR_ATTACHMENT0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, rgb.data());
    studio::Image image(width, height);
    const char* const names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<float>& plane = image.plane(names[c]);
        for (std::size_t y = 0; y < std::size_t(height); ++y)
            for (std::size_t x = 0; x < std::size_t(width); ++x)  // OpenGL's first row is the lowest
                plane[y * std::size_t(width) + x] =
                    studio::srgbDecode(float(rgb[((std::size_t(height) - 1 - y) * std::size_t(width) + x) * 3 + c]) / 255.0f);
    }
    studio::writePng(file, image);
}

void writeLayers(const std::string& file, const GBufferImages& images, const Texture& indirect) {
    studio::Image image(images.width, images.height);
    const std::vector<float> light = readTexture(indirect, GL_RED, 1);
    const char* const names[] = {"R", "G", "B", "validity"};
    const std::ptrdiff_t count = std::ptrdiff_t(image.pixelCount());
    for (std::ptrdiff_t i = 0; i < 4; ++i)
        std::copy(light.begin() + i * count, light.begin() + (i + 1) * count, image.plane(names[i]).begin());
    addLayer(image, "direct.", images.direct, false);
    addLayer(image, "albedo.", images.albedo, true);
    studio::writeExr(file, image);
}

std::string toJson(const Report& report) {
    Json json;
    double host = 0.0;
    const Json stages = stagesJson(report, host);
    json["scene"] = report.scene->name;
    json["camera"] = report.camera;
    json["size"] = {report.width, report.height};
    json["frames"] = report.timings->frameCount();
    json["opengl"] = {{"renderer", reinterpret_cast<const char*>(glGetString(GL_RENDERER))},
                      {"version", reinterpret_cast<const char*>(glGetString(GL_VERSION))},
                      {"context", report.context}};
    json["frame_ms"] = report.timings->frameMilliseconds();
    json["host_ms"] = host;
    json["lightwell_ms"] = medianWall(*report.indirectFrames, false);
    json["stages_ms"] = stages;
    json["copied_bytes"] = {{"read_back", report.readBackBytes}, {"upload", report.uploadBytes}};
    json["lightwell"] = indirectJson(report);
    json["rsms"] = rsmsJson(report);
    if (report.options->checks) json["findings"] = findingsJson(report);
    json["exposure"] = report.exposure;
    Json outputs = Json::array();
    for (const std::string& file : {report.options->screenshot, report.options->out})
        if (!file.empty()) outputs.push_back(file);
    json["outputs"] = outputs;
    return json.dump(2) + "\n";
}

std::string toText(const Report& report) {
    double host = 0.0;
    const Json stages = stagesJson(report, host);
    std::string text = fmt::format("{}, camera {}, {}x{}, {} {}\n", report.scene->name, report.camera, report.width, report.height,
                                   report.indirect->settings().technique, report.indirect->settings().text());
    text += fmt::format("{} ({})\n{} ({})\n", reinterpret_cast<const char*>(glGetString(GL_RENDERER)), report.context,
                        report.indirect->deviceInfo().name, report.indirect->sharing());
    text += fmt::format("frame {:.2f} ms, of it host {:.2f} ms, Lightwell {:.2f} ms (medians of {} frames)\n", report.timings->frameMilliseconds(), host,
                        medianWall(*report.indirectFrames, false), report.timings->frameCount());
    for (const auto& [name, milliseconds] : report.timings->stages()) text += fmt::format("  {:<32} {:9.3f} ms\n", name, milliseconds);
    for (const PassTime& pass : medianPasses(*report.indirectFrames)) text += fmt::format("    {:<30} {:9.3f} ms\n", pass.name, pass.milliseconds);
    for (const LWInputFinding& finding : *report.findings) text += fmt::format("check: {}: {}\n", finding.argument, finding.message);
    for (const std::string& file : {report.options->screenshot, report.options->out})
        if (!file.empty()) text += fmt::format("wrote {}\n", file);
    return text;
}

}  // namespace viewer
