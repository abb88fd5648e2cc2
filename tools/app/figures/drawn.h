// Draws the paper's figures of a run, and returns the numbers that the figures show.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "tools/app/figures/frame_information/sweep.h"
#include "tools/app/figures/run_collector.h"
#include "tools/figure/figure.h"

namespace kaz::tools {

struct DrawnFigure {
  figure::Image picture;
  nlohmann::ordered_json numbers;  // values that the picture shows, in SI units
};

// Each figure has the same layout as in the paper. Except for figure 7, the functions fail (Fault::failed) if
// the run does not contain the data of the figure.
Result<DrawnFigure> draw_scene(const RunCollector& run);         // draws figure 3
Result<DrawnFigure> draw_setup(const RunCollector& run);         // draws figure 5
Result<DrawnFigure> draw_map_and_path(const RunCollector& run);  // draws figure 6
// Draws figure 7.
DrawnFigure draw_frame_information(const figure7::Sweep& sweep, const figure7::Options& options);
Result<DrawnFigure> draw_catch(const RunCollector& run);  // draws figure 8

}  // namespace kaz::tools
