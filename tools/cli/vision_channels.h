// Publishes the vision results of a run to viewers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/viewer/view.h"
#include "tools/vision/modules.h"

namespace kaz::tools {

// Publishes a picture of each running module's results, like the pictures of `kaz vision run`: /vision/depth,
// /vision/flow and /vision/floor. The ball is published as an annotation of the left eye's picture. Pictures
// without subscribers are not drawn.
class VisionChannels final : public VisionWatcher {
 public:
  // `view` must outlive this object and the pipeline.
  explicit VisionChannels(viewer::View& view) : view_(view) {}
  void begin(vision::Pipeline& pipeline) override;
  void end(const vision::Pipeline& /*pipeline*/) override {}

 private:
  viewer::View& view_;
};

}  // namespace kaz::tools
