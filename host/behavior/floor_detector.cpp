// Collects the floor of each picture from the pipeline.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/floor_detector.h"

#include <utility>

#include "vision/pipeline/pipeline.h"

namespace kaz::behavior {

namespace {

constexpr std::size_t kMaxPictures = 8;

}  // namespace

PipelineFloorDetector::PipelineFloorDetector(vision::Pipeline& pipeline) {
  const auto subscribed = pipeline.subscribe<
      vision::PlaneSegments>("floor", [this](const vision::Frame& frame,
                                             const vision::PlaneSegments* planes,
                                             const Error* error) {
    if (planes != nullptr) {
      if (pictures_.size() == kMaxPictures) pictures_.erase(pictures_.begin());
      pictures_.push_back({*planes, frame.of<vision::DepthImage>("depth"), frame.shared_images()});
    } else if (!error_) {
      error_ = *error;
    }
  });
  if (!subscribed) error_ = subscribed.error();
}

Result<std::vector<FloorPicture>> PipelineFloorDetector::take() {
  if (error_) return tl::unexpected(*error_);
  return std::exchange(pictures_, {});
}

}  // namespace kaz::behavior
