// Hands new pairs to the pipeline and takes what was seen of the ball.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/pipeline_sight.h"

#include <utility>

namespace kaz::behavior {

PipelineSight::PipelineSight(vision::Camera& camera, vision::Pipeline& pipeline)
    : camera_(camera), pipeline_(pipeline) {
  const auto subscribed = pipeline.subscribe<vision::BallObservation>(
      "color",
      [this](const vision::Frame&, const vision::BallObservation* ball, const Error* error) {
        if (ball != nullptr) {
          seen_.push_back(*ball);
        } else if (!trouble_) {
          trouble_ = *error;
        }
      });
  if (!subscribed) trouble_ = subscribed.error();
}

Result<std::vector<vision::BallObservation>> PipelineSight::poll(Time now) {
  while (true) {
    auto pair = camera_.poll();
    if (!pair) return tl::unexpected(pair.error());
    if (!*pair) break;
    pipeline_.submit(std::move(**pair));
  }
  pipeline_.poll(now);
  if (trouble_) return tl::unexpected(*trouble_);
  return std::exchange(seen_, {});
}

}  // namespace kaz::behavior
