// How the eye went between two pictures: as the posture says, put right by what the flow says.
// Inside of vision/.
// SPDX-License-Identifier: Apache-2.0
//
// Posture is wrong by noise and codes of the potentiometers, play of the gears, and sway that no
// joint knows: several px of flow in the whole picture, while what moves by itself is a part of it.
// So turn and way of the eye are corrected by the small motion that leaves most of the picture at
// rest: Gauss-Newton on six numbers, cells that do not fit weighing less (J. Tukey's biweight, at
// 4.685 standard deviations as the median of the residuals has them), and the posture itself one
// more measurement of them. m, rad, px; optical frames.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "vision/image/frame.h"

namespace kaz::vision {

// Flow of one cell, and the range of 1/depth (1/m) that it may have.
struct FlowSample {
  Eigen::Vector2d at, flow;
  double least, most;
};

// Standard deviations of the posture's error, between the two exposures.
struct PostureError {
  double turn_rad, shift_m;
};

class EgoMotion {
 public:
  EgoMotion(const FrameInfo& before, const FrameInfo& after)
      : camera_(before.camera), later_(after.foot_from_eye.inverse() * before.foot_from_eye) {}

  Eigen::Vector3d ray(double u, double v) const {
    return {(u - camera_.cx) / camera_.fx, (v - camera_.cy) / camera_.fy, 1};
  }
  // Flow of what rests; false where the point comes to lie behind the eye.
  bool flow(double u, double v, double inverse_depth, Eigen::Vector2d& px) const {
    const Eigen::Vector3d p = later_.linear() * ray(u, v) + inverse_depth * later_.translation();
    if (p.z() < 0.05) return false;
    px = {camera_.fx * p.x() / p.z() + camera_.cx - u, camera_.fy * p.y() / p.z() + camera_.cy - v};
    return true;
  }
  // Later optical frame from the earlier one.
  const Eigen::Isometry3d& later() const { return later_; }

  // What of the flow no depth within the range explains. `way` is the direction, of length 1, that
  // depth leaves open there; zero where the range ends first. False as flow().
  bool residual(const FlowSample& sight, Eigen::Vector2d& px, Eigen::Vector2d& way) const;

  struct Correction {
    Eigen::Vector3d turn_rad{0, 0, 0}, shift_m{0, 0, 0};  // later optical frame
    double spread_px = 0;  // standard deviation, each way, of what is left: from the median
  };
  // Corrects this motion and says by what. Fewer than 50 sights correct nothing.
  Correction correct(std::span<const FlowSample> sights, const PostureError& error);

 private:
  CameraModel camera_;
  Eigen::Isometry3d later_;
};

}  // namespace kaz::vision
