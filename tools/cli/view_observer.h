// Publishes the pictures and vision results of a run to viewers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/run/run_observer.h"
#include "tools/viewer/view.h"

namespace kaz::tools {

// Publishes the eyes' pictures, and a picture of each running module's results, like the pictures of
// `kaz vision run`: /vision/depth, /vision/flow and /vision/floor. The ball is published as an annotation of
// the left eye's picture. Pictures without subscribers are not drawn.
class ViewObserver final : public RunObserver {
 public:
  // `view` must outlive this object and the pipeline.
  explicit ViewObserver(viewer::View& view) : view_(view) {}
  void begin_vision(vision::Pipeline& pipeline) override;
  void pair(const vision::StereoPair& pair) override { view_.picture(pair); }

 private:
  viewer::View& view_;
};

}  // namespace kaz::tools
