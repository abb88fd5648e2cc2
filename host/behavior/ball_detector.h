// Source of ball observations for behaviors, and its implementation by the vision pipeline.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "vision/color/ball.h"

namespace kaz::vision {
class Pipeline;
}

namespace kaz::behavior {

class BallDetector {
 public:
  virtual ~BallDetector() = default;
  // Returns the results of all images processed since the last call, in order of exposure. Images without a
  // ball are included. Never blocks. Fails if no more images will come; the message contains the reason.
  virtual Result<std::vector<vision::BallObservation>> poll(Time now) = 0;
};

// Submits the camera's image pairs to the pipeline. Collects the results of the pipeline's module "color".
class PipelineBallDetector final : public BallDetector {
 public:
  // `camera` must add the robot's posture to its pairs (host/camera/capture.h). The pipeline must contain the
  // module "color", or poll() fails; other modules are optional. Camera and pipeline must outlive this
  // object.
  PipelineBallDetector(vision::Camera& camera, vision::Pipeline& pipeline);
  PipelineBallDetector(const PipelineBallDetector&) = delete;
  PipelineBallDetector& operator=(const PipelineBallDetector&) = delete;

  Result<std::vector<vision::BallObservation>> poll(Time now) override;

 private:
  vision::Camera& camera_;
  vision::Pipeline& pipeline_;
  std::vector<vision::BallObservation> observations_;
  std::optional<Error> error_;
};

}  // namespace kaz::behavior
