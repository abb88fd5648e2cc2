// Source of ball observations and floor pictures for behaviors, and its implementation by the pipeline.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "shared/base/result.hpp"
#include "vision/color/ball.h"
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

class Vision {
 public:
  virtual ~Vision() = default;
  // Processes new images. Returns the ball observations of all images processed since the last call, in order
  // of exposure. Images without a ball are included. Never blocks. Fails if no more images will come; the
  // message contains the reason. ControlCycle::next() calls poll().
  virtual Result<std::vector<vision::BallObservation>> poll(Time now) = 0;
  // Returns the floor pictures that poll() has collected since the last call, at most the newest eight, in
  // order of exposure. Never blocks. Fails if vision failed (the message contains the reason), or if the
  // behavior's needs_floor is false.
  virtual Result<std::vector<FloorPicture>> take_floor() = 0;
};

// Submits the camera's image pairs to the pipeline. Collects the results of the modules "color" and "floor".
class PipelineVision final : public Vision {
 public:
  // `camera` must add the robot's posture to its pairs (host/camera/capture.h). The pipeline must contain the
  // module "color", or poll() fails. If `needs_floor` is true, the pipeline must also contain the module
  // "floor", or take_floor() fails. Camera and pipeline must outlive this object.
  PipelineVision(vision::Camera& camera, vision::Pipeline& pipeline, bool needs_floor = false);
  PipelineVision(const PipelineVision&) = delete;
  PipelineVision& operator=(const PipelineVision&) = delete;

  Result<std::vector<vision::BallObservation>> poll(Time now) override;
  Result<std::vector<FloorPicture>> take_floor() override;

 private:
  vision::Camera& camera_;
  vision::Pipeline& pipeline_;
  std::vector<vision::BallObservation> balls_;
  std::vector<FloorPicture> floors_;
  std::optional<Error> ball_error_, floor_error_;
};

}  // namespace kaz::behavior
