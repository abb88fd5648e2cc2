// Vision modules by name, for the command line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "vision/pipeline/modules.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::tools {

struct VisionOptions {
  std::string modules = "color";  // names, separated by commas
  vision::BallOptions ball;
  vision::DepthOptions depth;
  // Additional files of VisionReport for each frame with depth.
  bool export_depth = false, export_points = false;
};

// Returns all names, separated by commas.
std::string module_names();
// Returns the names in `list` and those that they need, each once, in the order for add_modules(). Fails
// (usage) for an unknown or repeated name.
Result<std::vector<std::string>> parse_modules(const std::string& list);
// Adds the modules of `options`, and those that they need, to the pipeline.
Result<void> add_modules(const VisionOptions& options, vision::Pipeline& pipeline);

// Observer of the results of vision during a run.
class VisionWatcher {
 public:
  virtual ~VisionWatcher() = default;
  // Called after the modules were added, before the first picture.
  virtual void begin(vision::Pipeline& pipeline) = 0;
  // Called after the last picture, also of a failed run.
  virtual void end(const vision::Pipeline& pipeline) = 0;
  // Whether it needs no further frames.
  virtual bool full() const { return false; }
};

}  // namespace kaz::tools
