// Submits image pairs to the pipeline, and collects ball observations and floor pictures.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/vision.h"

#include <utility>

#include "vision/pipeline/pipeline.h"

namespace kaz::behavior {

namespace {

constexpr std::size_t kMaxFloors = 8;

}  // namespace

PipelineVision::PipelineVision(vision::Camera& camera, vision::Pipeline& pipeline, bool needs_floor)
    : camera_(camera), pipeline_(pipeline) {
  const auto ball = pipeline.subscribe<vision::BallObservation>(
      "color",
      [this](const vision::Frame&, const vision::BallObservation* seen, const Error* error) {
        if (seen != nullptr) {
          balls_.push_back(*seen);
        } else if (!ball_error_) {
          ball_error_ = *error;
        }
      });
  if (!ball) ball_error_ = ball.error();
  if (!needs_floor) {
    floor_error_ = Error{Fault::usage, "this behavior gets no floor: set Behavior::needs_floor"};
    return;
  }
  const auto floor = pipeline.subscribe<
      vision::PlaneSegments>("floor", [this](const vision::Frame& frame,
                                             const vision::PlaneSegments* planes,
                                             const Error* error) {
    if (planes != nullptr) {
      if (floors_.size() == kMaxFloors) floors_.erase(floors_.begin());
      floors_.push_back({*planes, frame.of<vision::DepthImage>("depth"), frame.shared_images()});
    } else if (!floor_error_) {
      floor_error_ = *error;
    }
  });
  if (!floor) floor_error_ = floor.error();
}

Result<std::vector<vision::BallObservation>> PipelineVision::poll(Time now) {
  while (true) {
    auto pair = KAZ_TRY(camera_.poll());
    if (!pair) break;
    pipeline_.submit(std::move(*pair));
  }
  pipeline_.poll(now);
  if (ball_error_) return tl::unexpected(*ball_error_);
  return std::exchange(balls_, {});
}

Result<std::vector<FloorPicture>> PipelineVision::take_floor() {
  if (floor_error_) return tl::unexpected(*floor_error_);
  return std::exchange(floors_, {});
}

}  // namespace kaz::behavior
