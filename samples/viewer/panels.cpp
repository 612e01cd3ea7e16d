#include "panels.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "app.h"

namespace viewer {
namespace {

constexpr float kLeftWidth = 300.0f, kRightWidth = 326.0f, kMargin = 10.0f;
constexpr double kSmallPass = 0.02;  // of Lightwell's time: shown with others like it
constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
const ImVec4 kWarm(1.0f, 0.78f, 0.36f, 1.0f), kGrey(0.62f, 0.64f, 0.68f, 1.0f), kBad(1.0f, 0.45f, 0.4f, 1.0f);

void setStyle() {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 6.0f;
    style.FrameRounding = style.GrabRounding = 3.0f;
    style.WindowBorderSize = 0.0f;
    style.FramePadding = ImVec2(6.0f, 3.0f);
    style.ItemSpacing = ImVec2(7.0f, 5.0f);
    ImVec4* colours = style.Colors;
    colours[ImGuiCol_WindowBg] = ImVec4(0.07f, 0.075f, 0.085f, 0.86f);
    colours[ImGuiCol_TitleBg] = colours[ImGuiCol_TitleBgActive] = ImVec4(0.13f, 0.14f, 0.16f, 0.95f);
    colours[ImGuiCol_FrameBg] = ImVec4(0.19f, 0.2f, 0.23f, 0.9f);
    colours[ImGuiCol_Header] = ImVec4(0.2f, 0.22f, 0.26f, 0.9f);
    colours[ImGuiCol_SliderGrab] = colours[ImGuiCol_CheckMark] = ImVec4(1.0f, 0.72f, 0.3f, 1.0f);
    colours[ImGuiCol_SliderGrabActive] = ImVec4(1.0f, 0.82f, 0.5f, 1.0f);
    colours[ImGuiCol_PlotHistogram] = ImVec4(0.95f, 0.65f, 0.25f, 0.9f);
}

bool fileExists(const char* path) {
    std::FILE* file = std::fopen(path, "rb");
    if (file != nullptr) std::fclose(file);
    return file != nullptr;
}

void tip(const char* text) {
    if (!ImGui::IsItemHovered()) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(420.0f);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void wrapped(const ImVec4& colour, const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

// True when another one was picked.
bool pick(const char* label, std::string& value, const std::vector<std::string>& names) {
    bool isPicked = false;
    if (!ImGui::BeginCombo(label, value.c_str(), ImGuiComboFlags_HeightLarge)) return false;
    for (const std::string& name : names) {
        if (ImGui::Selectable(name.c_str(), name == value) && name != value) {
            value = name;
            isPicked = true;
        }
    }
    ImGui::EndCombo();
    return isPicked;
}

std::vector<std::string> choicesOf(const LWParameter& parameter) {
    std::vector<std::string> names;
    for (const char* const* choice = parameter.choices; choice != nullptr && *choice != nullptr; ++choice) names.emplace_back(*choice);
    return names;
}

// PoCL's names are long.
std::string shortName(const std::string& name) {
    constexpr std::size_t kLongest = 32;
    return name.size() > kLongest ? name.substr(0, kLongest - 3) + "..." : name;
}

void beginPanel(const char* title, bool isRight, int width, int height, float share) {
    const float panelWidth = isRight ? kRightWidth : kLeftWidth;
    ImGui::SetNextWindowPos(ImVec2(isRight ? float(width) - panelWidth - kMargin : kMargin, kMargin), ImGuiCond_Once);
    ImGui::SetNextWindowSizeConstraints(ImVec2(panelWidth, 0.0f), ImVec2(panelWidth, std::max(120.0f, share * (float(height) - 2.0f * kMargin))));
    ImGui::Begin(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PushItemWidth(150.0f);
}

void endPanel() {
    ImGui::PopItemWidth();
    ImGui::End();
}

void bar(const char* name, double milliseconds, double of, bool isStrong) {
    ImGui::PushStyleColor(ImGuiCol_PlotHistogram, isStrong ? ImVec4(0.95f, 0.65f, 0.25f, 0.9f) : ImVec4(0.42f, 0.5f, 0.62f, 0.9f));
    ImGui::ProgressBar(of > 0.0 && milliseconds > 0.0 ? float(milliseconds / of) : 0.0f, ImVec2(60.0f, 12.0f), "");
    ImGui::PopStyleColor();
    ImGui::SameLine();
    ImGui::Text(milliseconds < 0.0 ? "      -" : "%7.2f", milliseconds);
    ImGui::SameLine();
    ImGui::TextUnformatted(name);
}

}  // namespace

Panels::Panels(Context& context) : context_(context) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // writes nothing beside what is asked for
    if (fileExists(kFont)) io.Fonts->AddFontFromFileTTF(kFont, 14.0f);
    setStyle();
    if (context.window() != nullptr) ImGui_ImplGlfw_InitForOpenGL(context.window(), true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
}

Panels::~Panels() {
    ImGui_ImplOpenGL3_Shutdown();
    if (context_.window() != nullptr) ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Panels::begin(int width, int height, float seconds) {
    ImGui_ImplOpenGL3_NewFrame();
    if (context_.window() != nullptr) {
        ImGui_ImplGlfw_NewFrame();
    } else {
        ImGui::GetIO().DisplaySize = ImVec2(float(width), float(height));
        ImGui::GetIO().DeltaTime = std::max(seconds, 1e-4f);
    }
    ImGui::NewFrame();
}

void Panels::draw(App& app, GLuint target) {
    takeKeys(app);
    if (!isHidden_) {
        beginPanel("Lightwell", false, app.width(), app.height(), 0.8f);
        drawTechnique(app);
        drawLights(app);
        endPanel();
        beginPanel("Frame", true, app.width(), app.height(), 1.0f);
        drawTimes(app);
        drawView(app);
        drawPath(app);
        drawCheck(app);
        endPanel();
    }
    ImGui::Render();
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(0, 0, app.width(), app.height());
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Panels::takeKeys(App& app) {
    if (context_.window() == nullptr || ImGui::GetIO().WantTextInput) return;
    if (context_.isPressed(GLFW_KEY_ESCAPE)) glfwSetWindowShouldClose(context_.window(), GLFW_TRUE);
    if (context_.isPressed(GLFW_KEY_H)) isHidden_ = !isHidden_;
    if (context_.isPressed(GLFW_KEY_P)) app.askForScreenshot();
    if (context_.isPressed(GLFW_KEY_SPACE)) app.isPlaying() = !app.isPlaying();
    if (context_.isPressed(GLFW_KEY_C)) app.askForCheck();
    if (context_.isPressed(GLFW_KEY_K)) app.path().add(app.time(), app.camera().camera());
    const std::vector<std::string>& names = showNames();
    if (context_.isPressed(GLFW_KEY_TAB)) app.look().show = Show((int(app.look().show) + 1) % (int(names.size()) - 2));
}

void Panels::drawTechnique(App& app) {
    const LWDeviceInfo& device = app.indirect().deviceInfo();
    wrapped(kGrey, fmt::format("{}, width {}", shortName(device.name), device.width));
    Settings settings = app.settings();
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < lwCountTechniques(); ++i) {
        LWTechniqueInfo info{};
        info.structSize = sizeof info;
        if (lwDescribeTechnique(i, &info) == LW_SUCCESS) names.emplace_back(info.name);
    }
    if (pick("technique", settings.technique, names)) {
        settings.assignments.clear();
        app.choose(settings);
    }
    tip(describeTechnique(app.settings().technique).summary);
    drawPlanner(app);
    settings = app.settings();
    if (ImGui::CollapsingHeader("Parameters", ImGuiTreeNodeFlags_DefaultOpen)) {
        const bool isReset = !settings.assignments.empty() && ImGui::SmallButton("defaults");
        if (isReset) settings.assignments.clear();
        if (drawParameters(describeTechnique(settings.technique), "", settings) || isReset) app.choose(settings);
    }
    if (!app.message().empty()) wrapped(kBad, app.message());
    if (!app.notice().empty()) wrapped(kGrey, app.notice());
}

// On: technique "auto" in place of the one that was chosen, which comes back.
void Panels::drawPlanner(App& app) {
    Settings settings = app.settings();
    bool isOn = settings.technique == LW_TECHNIQUE_AUTO;
    if (ImGui::Checkbox("planner", &isOn)) {
        if (isOn) before_ = settings.technique;
        settings = Settings{isOn ? LW_TECHNIQUE_AUTO : before_, {}};
        app.choose(settings);
    }
    tip("Technique \"auto\": in each frame what the planner finds best within the budget");
    if (!isOn) return;
    ImGui::SameLine();
    const auto given = settings.assignments.find("budget_ms");
    float budget = held_.count("budget") != 0 ? held_["budget"]
                                              : given != settings.assignments.end() ? std::strtof(given->second.c_str(), nullptr) : 0.0f;
    if (ImGui::SliderFloat("ms", &budget, 0.0f, 200.0f, budget > 0.0f ? "budget %.1f" : "no budget")) held_["budget"] = budget;
    if (ImGui::IsItemDeactivatedAfterEdit()) {
        held_.erase("budget");
        settings.assignments["budget_ms"] = fmt::format("{}", budget);
        app.choose(settings);
    }
    for (const auto& [name, reason] : app.indirect().figures().choices)
        if (name == LW_TECHNIQUE_AUTO) wrapped(kWarm, reason);
}

bool Panels::drawParameters(const LWTechniqueInfo& info, const std::string& prefix, Settings& settings) {
    bool isChanged = false;
    for (std::uint32_t i = 0; i < info.parameterCount; ++i) {
        const LWParameter& parameter = info.parameters[i];
        const std::string key = prefix + parameter.name;
        ImGui::PushID(key.c_str());
        isChanged = drawParameter(parameter, key, settings) || isChanged;
        tip(parameter.description);
        if (parameter.kind == LW_PARAMETER_TECHNIQUE) {
            const auto chosen = settings.assignments.find(key);
            const std::string name = chosen != settings.assignments.end() ? chosen->second : defaultText(parameter);
            ImGui::Indent();
            if (ImGui::TreeNode("parameters of", "parameters of %s", name.c_str())) {
                isChanged = drawParameters(describeTechnique(name), key + ".", settings) || isChanged;
                ImGui::TreePop();
            }
            ImGui::Unindent();
        }
        ImGui::PopID();
    }
    return isChanged;
}

bool Panels::drawParameter(const LWParameter& parameter, const std::string& key, Settings& settings) {
    const auto given = settings.assignments.find(key);
    const std::string before = given != settings.assignments.end() ? given->second : defaultText(parameter);
    std::string text = before;
    if (parameter.kind == LW_PARAMETER_ENUM || parameter.kind == LW_PARAMETER_TECHNIQUE) {
        pick(parameter.name, text, choicesOf(parameter));
    } else if (parameter.kind == LW_PARAMETER_BOOL) {
        bool isOn = text == "on" || text == "true" || text == "1";
        if (ImGui::Checkbox(parameter.name, &isOn)) text = isOn ? "on" : "off";
    } else if (parameter.allowedCount > 0) {
        std::vector<std::string> names;
        for (std::uint32_t i = 0; i < parameter.allowedCount; ++i) names.push_back(fmt::format("{}", parameter.allowed[i]));
        pick(parameter.name, text, names);
    } else if (!drawNumber(parameter, key, text)) {
        return false;
    }
    if (text == before) return false;
    if (parameter.kind == LW_PARAMETER_TECHNIQUE)  // what was set of the technique before goes with it
        for (auto at = settings.assignments.begin(); at != settings.assignments.end();)
            at = at->first.rfind(key + ".", 0) == 0 ? settings.assignments.erase(at) : std::next(at);
    if (text == defaultText(parameter))
        settings.assignments.erase(key);
    else
        settings.assignments[key] = text;
    return true;
}

// A change counts when the slider is let go: it may mean other kernels.
bool Panels::drawNumber(const LWParameter& parameter, const std::string& key, std::string& text) {
    const bool isWhole = parameter.kind == LW_PARAMETER_UINT;
    const auto held = held_.find(key);
    float value = held != held_.end() ? held->second : std::strtof(text.c_str(), nullptr);
    const float low = float(parameter.minimum), high = float(parameter.maximum);
    const bool isWide = high > 1000.0f * std::max(1.0f, std::abs(low));
    const float speed = isWhole ? std::max(0.1f, 0.01f * std::abs(value)) : std::max(1e-4f, 0.005f * std::abs(value) + (isWide ? 0.0f : 0.0005f * (high - low)));
    const char* const format = isWhole ? "%.0f" : "%.4g";
    if (ImGui::DragFloat(parameter.name, &value, speed, low, high, format, ImGuiSliderFlags_AlwaysClamp))
        held_[key] = isWhole ? std::round(value) : value;
    if (!ImGui::IsItemDeactivatedAfterEdit()) return false;
    const auto last = held_.find(key);
    if (last == held_.end()) return false;
    text = isWhole ? fmt::format("{:.0f}", last->second) : fmt::format("{}", last->second);
    held_.erase(last);
    return true;
}

// Those that take a share worth a line; the rest in one.
void Panels::drawPasses(const IndirectFigures& figures) {
    double rest = 0.0;
    int restCount = 0;
    for (const PassTime& pass : figures.passes) {
        const bool isSmall = pass.milliseconds < kSmallPass * figures.wallMilliseconds;
        if (isSmall) rest += std::max(0.0, pass.milliseconds), ++restCount;
        if (!isSmall) bar(pass.name.c_str(), pass.milliseconds, figures.wallMilliseconds, true);
    }
    if (restCount > 0) bar(fmt::format("{} others", restCount).c_str(), rest, figures.wallMilliseconds, true);
}

void Panels::drawTimes(App& app) {
    const Timings& timings = app.timings();
    const double whole = timings.frameMilliseconds();
    const IndirectFigures& figures = app.indirect().figures();
    ImGui::TextColored(kWarm, "%.1f ms", whole);
    ImGui::SameLine();
    ImGui::Text("a frame, %dx%d", app.width(), app.height());
    wrapped(kGrey, fmt::format("{}\n{} triangles", reinterpret_cast<const char*>(glGetString(GL_RENDERER)), app.triangleCount()));
    for (const auto& [name, milliseconds] : timings.stages()) bar(name.c_str(), milliseconds, whole, name == "lightwell");
    if (ImGui::TreeNodeEx("passes", ImGuiTreeNodeFlags_DefaultOpen, "Lightwell's passes, %.1f ms", figures.deviceMilliseconds)) {
        drawPasses(figures);
        ImGui::TreePop();
    }
    if (ImGui::TreeNode("counts", "counts, %.1f MB on the device", double(figures.deviceBytes) / 1e6)) {
        for (const auto& [name, count] : figures.counts) ImGui::Text("%s: %llu", name.c_str(), static_cast<unsigned long long>(count));
        for (const auto& [name, reason] : figures.choices) wrapped(kGrey, name + ": " + reason);
        wrapped(kGrey, fmt::format("{:.1f} MB read back; {}", double(app.copiedBytes()) / 1e6, app.indirect().sharing()));
        ImGui::TreePop();
    }
}

void Panels::drawView(App& app) {
    if (!ImGui::CollapsingHeader("View", ImGuiTreeNodeFlags_DefaultOpen)) return;
    Look& look = app.look();
    std::string shown = showNames()[std::size_t(look.show)];
    if (pick("show", shown, showNames())) {
        look.show = Show(std::find(showNames().begin(), showNames().end(), shown) - showNames().begin());
        if (look.show == Show::Check) app.askForCheck();
        if (look.show == Show::Debug && app.options().debugView.empty() && !app.debugViews().empty())
            app.options().debugView = app.debugViews()[0].name;
        if (look.show == Show::Debug && app.debugViews().empty()) look.show = Show::Picture;
    }
    if (look.show == Show::Debug) drawDebugView(app);
    ImGui::Checkbox("automatic exposure", &look.isAutomatic);
    float stops = std::log2(look.exposure);
    if (ImGui::SliderFloat("exposure", &stops, -16.0f, 16.0f, "2^%.1f")) {
        look.exposure = std::exp2(stops);
        look.isAutomatic = false;
    }
    if (app.truthFits())
        ImGui::SliderFloat("split", &look.split, 0.0f, 1.0f, look.split < 1.0f ? "truth from %.2f" : "no truth");
    else if (!app.options().truth.empty())
        wrapped(kBad, "the truth has another size than the window");
}

void Panels::drawDebugView(App& app) {
    std::vector<std::string> names;
    const LWDebugView* chosen = nullptr;
    for (const LWDebugView& view : app.debugViews()) {
        names.emplace_back(view.name);
        if (app.options().debugView == view.name) chosen = &view;
    }
    pick("buffer", app.options().debugView, names);
    if (chosen == nullptr) return;
    wrapped(kGrey, fmt::format("{}x{}, {} channels: {}", chosen->width, chosen->height, chosen->channels, chosen->description));
    Look& look = app.look();
    ImGui::SliderFloat("scale", &look.debugScale, 1e-4f, 1e4f, "%.4g", ImGuiSliderFlags_Logarithmic);
    if (chosen->channels > 3) ImGui::SliderInt("channel", &look.debugChannel, 0, int(chosen->channels) - 1);
}

void Panels::drawLights(App& app) {
    if (app.lights().empty() || !ImGui::CollapsingHeader("Lights")) return;
    for (std::size_t i = 0; i < app.lights().size(); ++i) {
        studio::Light& light = app.lights()[i];
        ImGui::PushID(int(i));
        ImGui::TextUnformatted(light.name.c_str());
        float power = std::max({light.emitted.x, light.emitted.y, light.emitted.z});
        const glm::vec3 colour = power > 0.0f ? light.emitted / power : glm::vec3(1.0f);
        bool isChanged = ImGui::DragFloat(light.kind == studio::LightKind::Sun ? "W/m^2" : "W/sr", &power, 0.01f * std::max(power, 0.01f), 0.0f, 1e6f);
        if (isChanged) light.emitted = colour * power;
        if (light.kind != studio::LightKind::Sun) isChanged = ImGui::DragFloat3("position", &light.position.x, 0.01f) || isChanged;
        if (light.kind != studio::LightKind::Point) {
            glm::vec3 direction = light.direction;
            const bool isTurned = ImGui::DragFloat3("direction", &direction.x, 0.005f);
            if (isTurned && glm::length(direction) > 1e-3f) light.direction = glm::normalize(direction);
            isChanged = isChanged || isTurned;
        }
        if (isChanged) app.moveLights();
        ImGui::PopID();
    }
}

void Panels::drawPath(App& app) {
    if (!ImGui::CollapsingHeader("Camera")) return;
    ImGui::DragFloat("m/s", &app.camera().speed(), 0.01f, 0.001f, 1e4f, "%.3g", ImGuiSliderFlags_Logarithmic);
    ImGui::Checkbox("play", &app.isPlaying());
    ImGui::SameLine();
    ImGui::SliderFloat("s", &app.time(), 0.0f, std::max(app.path().duration(), 10.0f), "%.2f");
    if (ImGui::SmallButton("add key (K)")) app.path().add(app.time(), app.camera().camera());
    ImGui::SameLine();
    if (ImGui::SmallButton("write path")) app.writePath();
    ImGui::SameLine();
    if (ImGui::SmallButton("picture (P)")) app.askForScreenshot();
}

void Panels::drawCheck(App& app) {
    if (!ImGui::CollapsingHeader("Input check")) return;
    if (ImGui::SmallButton("check (C)")) app.askForCheck();
    tip("lwCheckInputs: takes a good part of a second; its overlay is shown by view \"check\"");
    for (const LWInputFinding& finding : app.findings()) {
        ImGui::ColorButton("##colour", ImVec4(finding.colour[0], finding.colour[1], finding.colour[2], 1.0f), 0, ImVec2(12.0f, 12.0f));
        ImGui::SameLine();
        wrapped(finding.severity == LW_SEVERITY_ERROR ? kBad : kGrey, fmt::format("{}: {}", finding.argument, finding.message));
    }
    if (app.findings().empty()) wrapped(kGrey, "nothing found, or not yet asked");
}

}  // namespace viewer
