#include "techniques/auto_parameters.h"

#include <cstddef>

#include "techniques/parameter_table.h"

namespace lightwell {

const std::vector<LWParameter>& autoParameters() {
    static const double kBudgets[] = {4.0, 8.0, 16.0, 33.0, 66.0};
    static const std::vector<LWParameter> parameters = {
        swept(parameter("budget_ms", "milliseconds of a frame, lwUpdate and all of its lwRender: more buys less error; 0: no limit", LW_PARAMETER_FLOAT,
                        offsetof(LWAutoDesc, budgetMs), 0.0, 1e6, double(16.6f)),
              kBudgets),
        parameter("error_target", "relMSE that is good enough: nothing dearer than what is predicted to reach it; 0: the least error within the budget",
                  LW_PARAMETER_FLOAT, offsetof(LWAutoDesc, errorTarget), 0.0, 1e6, 0.0),
        parameter("views", "views that a frame renders: what is predicted for a frame is for so many", LW_PARAMETER_UINT, offsetof(LWAutoDesc, views),
                  1.0, 64.0, 1.0),
        parameter("fade", "frames over which a change of technique is spread: more hide it better and show the old light longer; 0: at once",
                  LW_PARAMETER_UINT, offsetof(LWAutoDesc, fade), 0.0, 240.0, 12.0),
        parameter("patience", "frames for which something better must have been better: more switch less and later", LW_PARAMETER_UINT,
                  offsetof(LWAutoDesc, patience), 0.0, 10000.0, 30.0),
        parameter("gain", "how much better it must be: predicted error less than the present one's over 1 plus this; more switch less",
                  LW_PARAMETER_FLOAT, offsetof(LWAutoDesc, gain), 0.0, 100.0, double(0.1f)),
    };
    return parameters;
}

}  // namespace lightwell

extern "C" void lwDefaultAuto(LWAutoDesc* desc) {
    if (!desc) return;
    *desc = LWAutoDesc{};
    desc->structSize = sizeof *desc;
    desc->budgetMs = 16.6f;
    desc->errorTarget = 0.0f;
    desc->views = 1;
    desc->fade = 12;
    desc->patience = 30;
    desc->gain = 0.1f;
}
