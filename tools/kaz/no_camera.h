// A camera that sees nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vision/image/frame.h"

namespace kaz::tools {

// In front of a behaviour that does not look.
class NoCamera final : public vision::Camera {
 public:
  const vision::CameraModel& model() const override { return model_; }
  Result<std::optional<vision::StereoPair>> poll() override { return std::nullopt; }

 private:
  vision::CameraModel model_;
};

}  // namespace kaz::tools
