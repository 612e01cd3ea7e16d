// `lightwell stability`: drives every technique through the catalogue of failures, or through movements
// of scenes, and keeps stability.json.
//
// stability.json (one JSON object; numbers are null where a sequence has nothing to judge by):
//
//   format      "lightwell-stability 1"
//   header      written, size [w, h], frames, quick, build, versions, techniques,
//               device {name, platform, driver, opencl, compute_units, width} or null
//   sequences   list of {id ("<scene>.<movement>" of a scene's), failure, frames, size, scale, sweeps,
//   truth ("traced" or "dark"), samples,
//               values [per frame, what the sequence sweeps], sizes [[w, h] per frame], cuts [frames]}
//   results     list of {
//       id            "<technique>/<sequence>"
//       key           of everything that the figures depend on; another key is measured again
//       technique, sequence, settings (what differs from the defaults), parameters, bounces, device,
//       build
//
//       load_average  when the sequence began
//
//       indices       {error, flicker, ghost, leak, drift, spike}
//
//       floors        the same of one reference judged by another: what noise alone reads
//
//       errors        {relMSE, nrmse, bias}: means over the frames
//
//       error_floors  the same of the truth's own noise
//
//       not_finite    values that were NaN or infinite; largest: the greatest absolute irradiance
//
//       is_dark_truth, passes   whether all is finite and, for a truth of exactly 0, exactly 0
//
//       worst_frame, worst_reason
//       frames        list, per frame: the indices' names, floors {...}, relMSE, nrmse, bias, noise, ms
//       images        {picture, truth, error, triptych}: PNGs of the worst frame, below the folder
//   }
#pragma once

#include <string>
#include <vector>

#include "sequence.h"
#include "stability_choice.h"

namespace cli {

struct StabilityOptions {
    std::vector<std::string> techniques;
    std::vector<std::string> assignments;  // key=value, for each technique that has the key
    std::vector<SequenceChoice> sequences;
    std::string folder, device, truthDirectory;
    studio::SequenceSize size;
    int deviceWidth = 0;       // lanes per work-item; 0: by probe
    double truthEffort = 1.0;  // times each sequence's own number of samples
    bool quick = false, onlyTruths = false;
};

// Interrupted (interrupt.h) between two frames or passes of a truth, with finished sequences and truths
// saved.
void runStability(const StabilityOptions& options);

}  // namespace cli
