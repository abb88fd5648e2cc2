// The modules of vision by name, for the command line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "vision/pipeline/modules.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::tools {

struct VisionOptions {
  std::string modules = "color";  // names with commas between
  vision::BallOptions ball;
  vision::DepthOptions depth;
  // What VisionReport writes beside overlays, of each frame with depth.
  bool export_depth = false, export_points = false;
};

// All names there are, with commas between, for help.
std::string module_names();
// The names in the list and what these need, each once, in an order in which they can be added.
// An error for a name that there is none of.
Result<std::vector<std::string>> parse_modules(const std::string& list);
Result<void> add_modules(const VisionOptions& options, vision::Pipeline& pipeline);

// Whoever wants to hear what vision finds in a run.
class VisionWatcher {
 public:
  virtual ~VisionWatcher() = default;
  // After the modules have been added, before the first picture.
  virtual void begin(vision::Pipeline& pipeline) = 0;
  // After the last picture, also of a run that failed.
  virtual void end(const vision::Pipeline& pipeline) = 0;
  // Whether it has heard of as many frames as it wants.
  virtual bool full() const { return false; }
};

}  // namespace kaz::tools
