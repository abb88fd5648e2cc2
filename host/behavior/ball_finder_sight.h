// BallSight by way of the vision pipeline: camera, capture, ball finder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/ball_sight.h"
#include "vision/ball_finder.h"

namespace kaz::behavior {

class BallFinderSight final : public BallSight {
 public:
  // `camera` stamps its pairs with the posture (host/robot/capture.h). Both must outlive this.
  BallFinderSight(vision::Camera& camera, vision::BallFinder& finder)
      : camera_(camera), finder_(finder) {}

  Result<std::vector<vision::BallObservation>> poll(Time now) override;

 private:
  vision::Camera& camera_;
  vision::BallFinder& finder_;
};

}  // namespace kaz::behavior
