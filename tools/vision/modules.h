// Adds vision modules to a pipeline by name, for the command line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "vision/pipeline/modules.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::tools {

struct VisionOptions {
  std::string modules = "color";  // names of modules, separated by commas
  vision::BallOptions ball;
  vision::DepthOptions depth;
  // Whether VisionReport writes additional files for each frame with depth.
  bool export_depth = false, export_points = false;
};

// Returns the names of all modules, separated by commas.
std::string module_names();
// Returns the names in `list`, and the names of the modules that these modules need. Each name occurs once,
// in the order for add_modules(). Fails (usage) for an unknown or repeated name.
Result<std::vector<std::string>> parse_modules(const std::string& list);
// Adds the modules of `options` to the pipeline, and also the modules that these modules need.
Result<void> add_modules(const VisionOptions& options, vision::Pipeline& pipeline);

}  // namespace kaz::tools
