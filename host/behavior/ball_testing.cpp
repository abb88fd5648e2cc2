// Projection, noise and latency of the test's eyes.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/ball_testing.h"

#include <cmath>

#include "host/robot/kinematics.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

vision::CameraModel camera_model() {
  vision::CameraModel model;
  model.width = 320;
  model.height = 240;
  model.fx = model.fy = 160 / std::tan(40 * kDegree);
  model.cx = 159.5;
  model.cy = 119.5;
  model.baseline_m = 0.04;
  return model;
}

namespace {

Time exposure_of(std::uint64_t number) {
  return Time(static_cast<std::int64_t>(number) * 1'000'000'000 / 30);
}

}  // namespace

TestBall::TestBall(const host::TestBoard& board, const host::Robot& robot, Path path,
                   const Options& options)
    : board_(board),
      robot_(robot),
      path_(std::move(path)),
      options_(options),
      random_(options.seed) {
  while (exposure_of(next_) < board.now()) ++next_;
}

// Sum of twelve uniform numbers less six: standard deviation 1 (splitmix64, Vigna).
double TestBall::noise() {
  double sum = -6;
  for (int i = 0; i < 12; ++i) {
    std::uint64_t z = random_ += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    sum += static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  return sum;
}

Eigen::Vector3d TestBall::in_eye(Time t) const {
  return host::trunk_from_eye(board_.angles_at(t)).inverse() * path_(t);
}

vision::BallObservation TestBall::observe(Time exposure) {
  vision::BallObservation seen;
  seen.info.sequence = next_;
  seen.info.exposure = exposure;
  seen.info.camera = camera_model();
  if (const auto posture = robot_.posture_at(exposure)) {
    seen.info.posture_known = true;
    seen.info.joint_rad.assign(posture->angle.begin(), posture->angle.end());
  }
  const Eigen::Vector3d ball = in_eye(exposure);
  const vision::CameraModel& camera = seen.info.camera;
  if (ball.z() <= 0 || !visible(exposure)) return seen;
  seen.center_u = camera.fx * ball.x() / ball.z() + camera.cx + options_.noise_px * noise();
  seen.center_v = camera.fy * ball.y() / ball.z() + camera.cy + options_.noise_px * noise();
  seen.found = seen.center_u > 0 && seen.center_u < camera.width - 1 && seen.center_v > 0 &&
               seen.center_v < camera.height - 1;
  seen.direction = Eigen::Vector3d((seen.center_u - camera.cx) / camera.fx,
                                   (seen.center_v - camera.cy) / camera.fy, 1)
                       .normalized();
  seen.distance_m = ball.norm() * (1 + options_.distance_noise * noise());
  seen.confidence = 1;
  return seen;
}

Result<std::vector<vision::BallObservation>> TestBall::poll(Time now) {
  if (failure) return tl::unexpected(*failure);
  std::vector<vision::BallObservation> seen;
  while (exposure_of(next_) + options_.latency <= now) {
    if (!lost(exposure_of(next_))) seen.push_back(observe(exposure_of(next_)));
    ++next_;
  }
  return seen;
}

double TestBall::error_rad(Time t) const {
  const Eigen::Vector3d ball = in_eye(t);
  return std::atan2(std::hypot(ball.x(), ball.y()), ball.z());
}

double TestBall::share_within(double limit_rad, Time begin, Time end) const {
  int all = 0, within = 0;
  for (Time t = begin; t < end; t += std::chrono::milliseconds(1)) {
    ++all;
    if (error_rad(t) <= limit_rad) ++within;
  }
  return all ? static_cast<double>(within) / all : 0;
}

}  // namespace kaz::behavior
