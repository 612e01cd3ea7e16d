#include "panels.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app.h"
#include "panel_parts.h"

namespace viewer {
namespace {

constexpr float kLeftWidth = 318.0f, kRightWidth = 326.0f, kMargin = 10.0f;
constexpr double kSmallPass = 0.02;  // of Lightwell's time: shown with others like it
constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

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

void beginPanel(const char* title, bool isRight, int width, int height, float share, bool isMoved) {
    const float panelWidth = isRight ? kRightWidth : kLeftWidth;
    ImGui::SetNextWindowPos(ImVec2(isRight ? float(width) - panelWidth - kMargin : kMargin, kMargin), isMoved ? ImGuiCond_Always : ImGuiCond_Once);
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
    const bool isResized = app.width() != width_ || app.height() != height_;
    width_ = app.width();
    height_ = app.height();
    if (!isHidden_) {
        beginPanel("Lightwell", false, app.width(), app.height(), 0.8f, isResized);
        drawTechnique(app);
        drawLights(app);
        endPanel();
        beginPanel("Frame", true, app.width(), app.height(), 1.0f, isResized);
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
