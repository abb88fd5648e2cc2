// The paper's figures of a run as pictures, and the numbers that belong to them.
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
  nlohmann::ordered_json numbers;  // what the picture shows, in SI units
};

// Each laid out as in the paper. All but figure 7: errors (failed) say what the run has not shown.
Result<DrawnFigure> draw_scene(const RunCollector& run);         // 3
Result<DrawnFigure> draw_setup(const RunCollector& run);         // 5
Result<DrawnFigure> draw_map_and_path(const RunCollector& run);  // 6
DrawnFigure draw_frame_information(const figure7::Sweep& sweep, const figure7::Options& options);
Result<DrawnFigure> draw_catch(const RunCollector& run);  // 8

}  // namespace kaz::tools
