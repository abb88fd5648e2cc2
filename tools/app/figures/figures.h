// `kaz figures`: the paper's figures, each of one run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include "tools/app/session/backend_options.h"

namespace kaz::tools {

struct FiguresOptions {
  BackendOptions backend;  // its world is that of figures 5 and 6
  std::string out = "kaz-figures";
  std::set<int> only;         // of figure_numbers(); empty: all
  std::string goal = "ball";  // of figures 5 and 6, as navigate takes it
  std::string yard = "yard";  // world of figure 7: boxes on a floor
  std::string recording;      // of a run; its figures are drawn then, and no others
  bool json = false;          // result.json on standard output, no progress
};

// 3, 5, 6, 7, 8: those that show what a robot does.
const std::set<int>& figure_numbers();
// Leaves figureN.png, the same as figureN.jpg, figures.html and result.json in the folder, and each run in a
// folder of its own in it, named as its behaviour. False: a run did not succeed, or has not shown what a
// figure needs. Interrupted, the figures that are drawn by then are kept.
Result<bool> make_figures(const FiguresOptions& options);

}  // namespace kaz::tools
