// Source of floor pictures for behaviors, and its implementation by the vision pipeline.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "shared/base/result.hpp"
#include "vision/depth/depth.h"
#include "vision/planes/plane_segments.h"

namespace kaz::vision {
class Pipeline;
}

namespace kaz::behavior {

// Results for one image pair: depth and planes. The edges of the floor were refined with the left image.
struct FloorPicture {
  vision::PlaneSegments planes;  // planes.info is the frame information
  vision::DepthImage depth;
  std::shared_ptr<const vision::StereoImages> images;  // rectified images
};

class FloorDetector {
 public:
  virtual ~FloorDetector() = default;
  // Returns the results since the last call, at most the newest eight, in order of exposure. New results
  // arrive only while the BallDetector of the same Context is polled. Never blocks. Fails if vision failed;
  // the message contains the reason.
  virtual Result<std::vector<FloorPicture>> take() = 0;
};

// Collects the results of the pipeline's module "floor". Without this module, take() fails. The pipeline must
// outlive this object.
class PipelineFloorDetector final : public FloorDetector {
 public:
  explicit PipelineFloorDetector(vision::Pipeline& pipeline);
  PipelineFloorDetector(const PipelineFloorDetector&) = delete;
  PipelineFloorDetector& operator=(const PipelineFloorDetector&) = delete;

  Result<std::vector<FloorPicture>> take() override;

 private:
  std::vector<FloorPicture> pictures_;
  std::optional<Error> error_;
};

}  // namespace kaz::behavior
