// The panels over the picture, by Dear ImGui. Everything about a technique comes from lwDescribeTechnique: a new one
// needs nothing here.
#pragma once

#include <map>
#include <string>

#include "context.h"
#include "gl_objects.h"
#include "lightwell/lightwell.h"

namespace viewer {

class App;
struct IndirectFigures;
struct Settings;

class Panels {
public:
    explicit Panels(Context& context);
    ~Panels();
    Panels(const Panels&) = delete;
    Panels& operator=(const Panels&) = delete;

    void begin(int width, int height, float seconds);  // takes what mouse and keyboard did
    void draw(App& app, GLuint target);

private:
    void drawTechnique(App& app);
    void drawPlanner(App& app);
    bool drawParameters(const LWTechniqueInfo& info, const std::string& prefix, Settings& settings);
    bool drawParameter(const LWParameter& parameter, const std::string& key, Settings& settings);
    bool drawNumber(const LWParameter& parameter, const std::string& key, std::string& text);
    void drawPasses(const IndirectFigures& figures);
    void drawTimes(App& app);
    void drawView(App& app);
    void drawDebugView(App& app);
    void drawLights(App& app);
    void drawPath(App& app);
    void drawCheck(App& app);
    void takeKeys(App& app);

    Context& context_;
    std::map<std::string, float> held_;  // sliders that are being dragged
    std::string before_ = "ssvp";        // the technique that the planner replaced
    bool isHidden_ = false;
    int width_ = 0, height_ = 0;  // that panels have been placed in
};

}  // namespace viewer
