// Submits image pairs to the pipeline and collects the ball observations.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/ball_detector.h"

#include <utility>

#include "vision/pipeline/pipeline.h"

namespace kaz::behavior {

PipelineBallDetector::PipelineBallDetector(vision::Camera& camera, vision::Pipeline& pipeline)
    : camera_(camera), pipeline_(pipeline) {
  const auto subscribed = pipeline.subscribe<vision::BallObservation>(
      "color",
      [this](const vision::Frame&, const vision::BallObservation* ball, const Error* error) {
        if (ball != nullptr) {
          observations_.push_back(*ball);
        } else if (!error_) {
          error_ = *error;
        }
      });
  if (!subscribed) error_ = subscribed.error();
}

Result<std::vector<vision::BallObservation>> PipelineBallDetector::poll(Time now) {
  while (true) {
    auto pair = KAZ_TRY(camera_.poll());
    if (!pair) break;
    pipeline_.submit(std::move(*pair));
  }
  pipeline_.poll(now);
  if (error_) return tl::unexpected(*error_);
  return std::exchange(observations_, {});
}

}  // namespace kaz::behavior
