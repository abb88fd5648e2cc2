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

// Observer of the results of vision during a run.
class VisionWatcher {
 public:
  virtual ~VisionWatcher() = default;
  // Called after the modules were added, before the first picture.
  virtual void begin(vision::Pipeline& pipeline) = 0;
  // Called after the last picture, also if the run failed.
  virtual void end(const vision::Pipeline& pipeline) = 0;
  // Returns true if this observer needs no further frames.
  virtual bool full() const { return false; }
};

}  // namespace kaz::tools
