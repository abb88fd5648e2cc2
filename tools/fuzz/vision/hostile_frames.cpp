// Each decision takes a byte or two; zeros make a valid frame.
// SPDX-License-Identifier: Apache-2.0
#include "tools/fuzz/vision/hostile_frames.h"

#include <cmath>
#include <limits>

#include "shared/base/random.hpp"
#include "vision/image/pictures_testing.h"

namespace kaz::fuzz {
namespace {

using vision::Image;

constexpr int kWidth = 96, kHeight = 72;

// Noise of the place in the scene, so that the right picture is the left one moved.
Image textured(int width, int height, int shift, std::uint64_t seed) {
  Image image{width, height, {}};
  image.rgb.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const auto key = static_cast<std::uint64_t>((u + shift) / 2 + 4096 * (v / 2));
      image.rgb.insert(image.rgb.end(), 3, static_cast<std::uint8_t>(mix64(seed ^ key)));
    }
  }
  return image;
}

void paint_disc(Image& image, int u0, int v0, int radius) {
  for (int v = std::max(0, v0 - radius); v <= std::min(image.height - 1, v0 + radius); ++v) {
    for (int u = std::max(0, u0 - radius); u <= std::min(image.width - 1, u0 + radius); ++u) {
      if ((u - u0) * (u - u0) + (v - v0) * (v - v0) > radius * radius) continue;
      std::uint8_t* p = &image.rgb[static_cast<std::size_t>(v * image.width + u) * 3];
      p[0] = 215, p[1] = 25, p[2] = 20;
    }
  }
}

}  // namespace

HostileFrame valid_frame(std::uint64_t sequence, Time exposure) {
  HostileFrame frame;
  frame.info.sequence = sequence;
  frame.info.exposure = exposure;
  frame.info.camera = vision::test_camera(kWidth, kHeight);
  frame.info.posture_known = true;
  frame.info.foot_from_eye.translation() << 0, 0, 0.3;
  frame.info.foot_from_eye.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  auto images = std::make_shared<vision::StereoImages>();
  images->left = textured(kWidth, kHeight, 0, 5);
  images->right = textured(kWidth, kHeight, 6, 5);
  paint_disc(images->left, 40, 30, 9);
  paint_disc(images->right, 34, 30, 9);
  frame.images = images;
  return frame;
}

int HostileFrames::side() {
  constexpr int kSides[] = {kWidth,
                            kHeight,
                            64,
                            63,
                            32,
                            31,
                            16,
                            15,
                            8,
                            3,
                            1,
                            0,
                            200,
                            321,
                            8192,
                            8193,
                            16384,
                            1 << 30,
                            std::numeric_limits<int>::max(),
                            -1,
                            -kWidth};
  return kSides[choices_.below(std::size(kSides))];
}

double HostileFrames::number(double valid) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const double numbers[] = {valid, valid, valid * 1.5,  valid * 0.3, 0,  -valid, 1e-300, 1e300,
                            kInf,  -kInf, std::nan(""), 1,           -1, 1e9,    -1e9,   1e-9};
  return numbers[choices_.below(std::size(numbers))];
}

Image HostileFrames::picture(int width, int height) {
  Image image{width, height, {}};
  // What claims to be large comes with what fits into a small one.
  const long long pixels = static_cast<long long>(width) * height;
  if (width <= 0 || height <= 0 || pixels > 80000) {
    image.rgb.assign(choices_.below(2) == 0 ? 0 : 300, 100);
    return image;
  }
  switch (choices_.below(6)) {
    case 1:
      image.rgb.assign(static_cast<std::size_t>(pixels) * 3, choices_.byte());
      break;
    case 2:  // stripes
      for (long long i = 0; i < pixels * 3; ++i)
        image.rgb.push_back((i / 3 % width) / 4 % 2 == 0 ? 40 : 200);
      break;
    case 3: {  // red all over, or its half
      const long long from = choices_.below(2) == 0 ? 0 : pixels / 2;
      for (long long i = 0; i < pixels; ++i) {
        const bool red = i >= from;
        for (const int c : {red ? 215 : 90, red ? 25 : 90, red ? 20 : 90})
          image.rgb.push_back(static_cast<std::uint8_t>(c));
      }
      break;
    }
    default:
      image = textured(width, height, choices_.byte() % 32, choices_.byte());
  }
  for (unsigned discs = choices_.below(4); discs > 0; --discs) {
    const int u = choices_.byte() - 20, v = choices_.byte() - 20, radius = choices_.byte() % 64;
    paint_disc(image, u, v, radius);
  }
  const unsigned damage = choices_.below(8);
  if (damage == 1) image.rgb.resize(image.rgb.size() / 2);
  if (damage == 2) image.rgb.pop_back();
  if (damage == 3) image.rgb.push_back(0);
  if (damage == 4) image.rgb.clear();
  return image;
}

vision::CameraModel HostileFrames::camera(int width, int height) {
  vision::CameraModel c = vision::test_camera(std::max(width, 1), std::max(height, 1));
  c.width = width;
  c.height = height;
  for (double* v : {&c.fx, &c.fy, &c.cx, &c.cy, &c.baseline_m}) {
    if (choices_.below(8) == 7) *v = number(*v);
  }
  if (choices_.below(16) == 15) c.width = side();
  if (choices_.below(16) == 15) c.height = side();
  return c;
}

Eigen::Isometry3d HostileFrames::posture() {
  Eigen::Isometry3d pose = valid_frame(0, {}).info.foot_from_eye;
  switch (choices_.below(6)) {
    case 1:
      for (int i = 0; i < 3; ++i) pose.translation()[i] = number(i == 2 ? 0.3 : 0.1);
      break;
    case 2:
      for (double& v : pose.linear().reshaped()) v = number(0.5);
      break;
    case 3:
      pose.linear() *=
          Eigen::AngleAxisd(0.02 * choices_.byte(), Eigen::Vector3d::UnitX()).toRotationMatrix();
      break;
    case 4:
      pose.matrix().setZero();
      break;
    default:
      break;
  }
  return pose;
}

void HostileFrames::advance_clock() {
  constexpr std::int64_t kSteps[] = {33'000'000,  33'000'000,     100'000'000,    0, 1, -1,
                                     -33'000'000, 10'000'000'000, -10'000'000'000};
  const unsigned step = choices_.below(std::size(kSteps) + 3);
  if (step < std::size(kSteps)) {
    // Clocks that were at an end wrap, as a damaged file's numbers may.
    clock_ = Time(static_cast<std::int64_t>(static_cast<std::uint64_t>(clock_.count()) +
                                            static_cast<std::uint64_t>(kSteps[step])));
  } else if (step == std::size(kSteps)) {
    clock_ = Time::max();
  } else if (step == std::size(kSteps) + 1) {
    clock_ = Time::min();
  } else {
    clock_ = Time(0);
  }
  const unsigned skip = choices_.below(16);
  sequence_ += skip < 10 ? 1 : skip < 13 ? 0 : skip == 13 ? 5 : ~std::uint64_t{0} - 3;
}

HostileFrame HostileFrames::next() {
  advance_clock();
  HostileFrame frame;
  const bool usual = choices_.below(2) == 0;
  const int width = usual ? kWidth : side(), height = usual ? kHeight : side();
  frame.info.sequence = sequence_;
  frame.info.exposure = clock_;
  frame.info.camera = camera(width, height);
  frame.info.posture_known = choices_.below(4) != 3;
  frame.info.foot_from_eye = posture();
  frame.info.joint_rad.assign(choices_.below(3) == 2 ? 0 : 18, number(0));
  auto images = std::make_shared<vision::StereoImages>();
  images->left = picture(width, height);
  const unsigned pair = choices_.below(8);
  if (pair == 7) {
    const int w = side(), h = side();
    images->right = picture(w, h);
  } else if (pair < 4 && !images->left.rgb.empty()) {
    images->right = images->left;  // moved by a disparity of some pixels
    const std::size_t shift =
        std::min<std::size_t>(3 * choices_.below(32), images->left.rgb.size());
    std::copy(images->left.rgb.begin() + static_cast<std::ptrdiff_t>(shift), images->left.rgb.end(),
              images->right.rgb.begin());
  } else {
    images->right = picture(width, height);
  }
  if (choices_.below(32) != 31) frame.images = images;  // else the camera broke its promise
  return frame;
}

}  // namespace kaz::fuzz
