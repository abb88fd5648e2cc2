// `kaz figures`: draws the paper's figures, each from one run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include "tools/app/session/backend_options.h"

namespace kaz::tools {

struct FiguresOptions {
  BackendOptions backend;  // its world is for figures 5 and 6
  std::string out = "kaz-figures";
  std::set<int> only;         // numbers from figure_numbers(); empty: all
  std::string goal = "ball";  // for figures 5 and 6: option `goal` of navigate
  std::string yard = "yard";  // world for figure 7: boxes on a floor
  std::string recording;      // recording of a run; only the figures of this run are drawn
  bool json = false;          // prints result.json to standard output, and no progress
};

// Figures that show what a robot does: 3, 5, 6, 7, 8.
const std::set<int>& figure_numbers();
// Writes figureN.png and figureN.jpg, figures.html and result.json into the folder. Each run has its own
// subfolder, named as its behavior. Returns false if a run did not succeed, or lacks what a figure shows.
// After an interrupt the completed figures stay.
Result<bool> make_figures(const FiguresOptions& options);

}  // namespace kaz::tools
