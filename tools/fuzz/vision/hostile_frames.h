// Generates frames from the bytes of a fuzz input.
// SPDX-License-Identifier: Apache-2.0
// Pictures, camera models, postures and clocks may be valid or invalid.
#pragma once

#include <memory>

#include "hil/fuzz/choices.h"
#include "vision/image/frame.h"

namespace kaz::fuzz {

struct HostileFrame {
  vision::FrameInfo info;
  std::shared_ptr<const vision::StereoImages> images;
};

// Returns a valid frame of 96 x 72 px that shows a red ball in front of a textured background in both eyes.
HostileFrame valid_frame(std::uint64_t sequence, Time exposure);

class HostileFrames {
 public:
  // `choices` must outlive this object.
  explicit HostileFrames(hil::fuzz::Choices& choices) : choices_(choices) {}
  HostileFrame next();

 private:
  int side();
  double number(double valid);
  vision::Image picture(int width, int height);
  vision::CameraModel camera(int width, int height);
  Eigen::Isometry3d posture();
  void advance_clock();

  hil::fuzz::Choices& choices_;
  std::uint64_t sequence_ = 0;
  Time clock_{1'000'000'000};
};

}  // namespace kaz::fuzz
