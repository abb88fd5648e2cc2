// BallSight by way of the vision pipeline: camera, capture, the module that looks for the ball.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/ball_sight.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::behavior {

class PipelineSight final : public BallSight {
 public:
  // `camera` stamps its pairs with the posture (host/camera/capture.h); the pipeline has the module
  // "color" and may have others. Both must outlive this. Without that module poll() fails.
  PipelineSight(vision::Camera& camera, vision::Pipeline& pipeline);
  PipelineSight(const PipelineSight&) = delete;
  PipelineSight& operator=(const PipelineSight&) = delete;

  Result<std::vector<vision::BallObservation>> poll(Time now) override;

 private:
  vision::Camera& camera_;
  vision::Pipeline& pipeline_;
  std::vector<vision::BallObservation> seen_;
  std::optional<Error> trouble_;
};

}  // namespace kaz::behavior
