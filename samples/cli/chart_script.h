// Runs a Python script of samples/chart: plots and reports are made by its well-kept libraries.
#pragma once

#include <string>
#include <vector>

namespace cli {

// Throws std::runtime_error saying what to install when there is no Python with matplotlib, and when the
// script fails (its own message has gone to stderr).
void runChartScript(const std::string& script, const std::vector<std::string>& arguments);

}  // namespace cli
