// What the panels are made of, for panel*.cpp only.
#pragma once

#include <imgui.h>

#include <string>
#include <vector>

namespace viewer {

const ImVec4 kWarm(1.0f, 0.78f, 0.36f, 1.0f), kGrey(0.62f, 0.64f, 0.68f, 1.0f), kBad(1.0f, 0.45f, 0.4f, 1.0f);

void tip(const char* text);  // of the item before, when the mouse is over it
void wrapped(const ImVec4& colour, const std::string& text);
// A list to pick from; true when another one was picked.
bool pick(const char* label, std::string& value, const std::vector<std::string>& names);

}  // namespace viewer
