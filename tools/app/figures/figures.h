// `kaz figures`: draws the paper's figures, each from one run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include "tools/app/session/backend_options.h"

namespace kaz::tools {

struct FiguresOptions {
  BackendOptions backend;  // options of the robot; `world` is used for figures 5 and 6
  std::string out = "kaz-figures";
  // Numbers of the figures to draw, from figure_numbers(); empty: all figures.
  std::set<int> only;
  std::string goal = "ball";  // option `goal` of navigate in the run for figures 5 and 6
  std::string yard = "yard";  // world for figure 7, with boxes on a floor
  // Path of a recording; only the figures of the recorded run are drawn; empty: new runs.
  std::string recording;
  bool json = false;  // prints result.json to standard output, and no progress
};

// Numbers of the paper's figures that show a robot in action: 3, 5, 6, 7, 8.
const std::set<int>& figure_numbers();
// Writes figureN.png and figureN.jpg, figures.html and result.json into the folder. Each run has its own
// subfolder, named after the behavior. Returns false if a run did not succeed, or does not contain the data
// of a figure. After an interrupt the completed figures stay.
Result<bool> make_figures(const FiguresOptions& options);

}  // namespace kaz::tools
