// For tests: renders floor, boxes and ball by the simulator's moving eyes, and computes the true flow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim/render/renderer_kind.h"
#include "sim/render/scenes_testing.h"
#include "sim/render/sensor/eye_testing.h"
#include "sim/render/sensor/sensor.h"
#include "vision/calibration/rectify.h"

namespace kaz::sim {

// Pose of the left eye and position of the ball in the world, m. The foot is at the world's origin.
struct MovingPoses {
  Eigen::Isometry3d eye = Eigen::Isometry3d::Identity();
  Eigen::Vector3d ball{0.45, 0, 0.02};
};

class MovingScene {
 public:
  static constexpr double kBallRadius = 0.02;

  MovingScene(int width, const std::string& texture)
      : calibration_(make_calibration(model(width), 2, kEyeBaseline_m)),
        left_(model(width), calibration_, Sensor::Eye::left, 1),
        right_(model(width), calibration_, Sensor::Eye::right, 1),
        rectifier_(calibration_) {
    scene_.add_ground(texture);
    ball_frame_ = scene_.add_ball({0.45, 0, kBallRadius});
    boxes_ = {{{0.75, 0.22, 0.04}, {0.08, 0.10, 0.08}}, {{1.60, 0.00, 0.50}, {0.10, 4.00, 1.00}}};
    for (const Box& b : boxes_)
      scene_.add(Shape::Kind::box, b.size, b.middle, {0.5F, 0.7F, 0.6F}, "carpet");
    renderer_ = std::move(*maker_of(kDefaultRenderer)());
    EXPECT_TRUE(renderer_->set_scene(scene_.scene));
  }

  // Returns the pose of the left eye for a pan about the vertical axis. The eye is 3 cm in front of the axis
  // and 2 cm left of it.
  static Eigen::Isometry3d turned(double pan_rad, double tilt_rad = 0.55,
                                  const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
    return Eigen::Translation3d(shift) * Eigen::AngleAxisd(pan_rad, Eigen::Vector3d::UnitZ()) *
           look_at({0.03, 0.02, 0.3}, {0.03 + std::cos(tilt_rad), 0.02, 0.3 - std::sin(tilt_rad)});
  }

  const vision::CameraModel& camera() const { return calibration_.rectified; }

  vision::FrameInfo info(const MovingPoses& poses, std::uint64_t number) const {
    vision::FrameInfo info;
    info.sequence = number;
    info.exposure = from_seconds(static_cast<double>(number) / 30);
    info.camera = camera();
    info.posture_known = true;
    info.foot_from_eye = poses.eye;
    return info;
  }

  // Returns rectified pictures of real eyes, with lenses and the noise of exposure `number`.
  vision::StereoImages take(const MovingPoses& poses, std::uint64_t number) {
    scene_.pose.frames[static_cast<std::size_t>(ball_frame_)].translation() = poses.ball;
    vision::StereoImages raw, rectified;
    raw.left = sim::take(*renderer_, scene_.pose, left_, poses.eye, number);
    raw.right = sim::take(*renderer_, scene_.pose, right_,
                          poses.eye * Eigen::Translation3d(kEyeBaseline_m, 0, 0), number);
    rectifier_.rectify(raw, rectified);
    return rectified;
  }

  struct Hit {
    double depth_m = 0;  // along the optical axis; 0: no surface
    bool ball = false;
  };
  // Returns the surface at (u, v) of the left picture.
  Hit hit(const MovingPoses& poses, double u, double v) const {
    return along(poses, poses.eye.translation(), poses.eye.linear() * camera().ray(u, v));
  }
  // Returns the position of a point of the world in the left picture, px.
  Eigen::Vector2d pixel(const MovingPoses& poses, const Eigen::Vector3d& world) const {
    return camera().pixel(poses.eye.inverse() * world);
  }
  // Returns the true flow of the surface at (u, v), px. NaN if there is no surface, or if it is hidden or out
  // of the picture later.
  Eigen::Vector2d flow(const MovingPoses& before, const MovingPoses& after, double u,
                       double v) const {
    const vision::CameraModel& c = camera();
    const Hit h = hit(before, u, v);
    const Eigen::Vector2d none(NAN, NAN);
    if (h.depth_m <= 0) return none;
    Eigen::Vector3d at = before.eye * (h.depth_m * c.ray(u, v));
    if (h.ball) at += after.ball - before.ball;  // slides: rolling is invisible in one color
    const Eigen::Vector2d to = pixel(after, at);
    if (to.x() < 0 || to.y() < 0 || to.x() > c.width - 1 || to.y() > c.height - 1) return none;
    const Eigen::Vector3d from = after.eye.translation();
    if (along(after, from, at - from).depth_m < 1 - 1e-3) return none;
    return to - Eigen::Vector2d(u, v);
  }

 private:
  struct Box {
    Eigen::Vector3d middle, size;
  };
  static EyeModel model(int width) {
    EyeModel m;
    m.width = width;
    m.height = width * 3 / 4;
    return m;
  }

  // Returns the nearest surface along a ray. Its depth_m is in lengths of `ray`. So it is a depth if the ray
  // has z = 1 in the optical frame.
  Hit along(const MovingPoses& poses, const Eigen::Vector3d& from,
            const Eigen::Vector3d& ray) const {
    Hit best;
    if (ray.z() < 0) {
      const double depth = -from.z() / ray.z();
      const Eigen::Vector3d at = from + depth * ray;
      if (std::abs(at.x()) < 3 && std::abs(at.y()) < 3) best.depth_m = depth;
    }
    for (const Box& b : boxes_) {
      const Eigen::Array3d one = (b.middle - 0.5 * b.size - from).array() / ray.array();
      const Eigen::Array3d two = (b.middle + 0.5 * b.size - from).array() / ray.array();
      const double enter = one.min(two).maxCoeff(), leave = one.max(two).minCoeff();
      if (enter > 0 && enter < leave && (best.depth_m == 0 || enter < best.depth_m)) best = {enter};
    }
    const Eigen::Vector3d off = poses.ball - from;
    const double a = ray.squaredNorm(), b = ray.dot(off);
    const double root = b * b - a * (off.squaredNorm() - kBallRadius * kBallRadius);
    if (root > 0 && b > 0) {
      const double depth = (b - std::sqrt(root)) / a;
      if (best.depth_m == 0 || depth < best.depth_m) best = {depth, true};
    }
    return best;
  }

  vision::StereoCalibration calibration_;
  Sensor left_, right_;
  vision::Rectifier rectifier_;
  TestScene scene_;
  int ball_frame_ = 0;
  std::vector<Box> boxes_;
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace kaz::sim
