// What vision makes of a run's pictures, for viewers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/app/vision/modules.h"
#include "tools/view/view.h"

namespace kaz::tools {

// Pictures of the modules that run, /vision/depth, /vision/flow and /vision/floor, as in `kaz vision run`; of
// the ball an annotation on the left eye's picture. What nobody has subscribed to is not drawn.
class VisionChannels final : public VisionWatcher {
 public:
  // The view must outlive it.
  explicit VisionChannels(watch::View& view) : view_(view) {}
  void begin(vision::Pipeline& pipeline) override;
  void end(const vision::Pipeline& /*pipeline*/) override {}

 private:
  watch::View& view_;
};

}  // namespace kaz::tools
