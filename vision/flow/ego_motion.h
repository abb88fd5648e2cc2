// Ego-motion of the camera between two images: predicted from the postures, refined on the optical flow.
// Internal to vision/.
// SPDX-License-Identifier: Apache-2.0
//
// The pose from the joint angles has errors (noise and quantisation of the potentiometers, backlash, sway
// of the soles) that amount to several px of flow over the whole image, while independent motion affects
// a part of it. The pose is therefore corrected by a small rigid motion xi = (rotation, translation) by
// iteratively reweighted least squares (Gauss-Newton) on the flow: Tukey's biweight with c = 4.685,
// scale from the median residual, and a Gaussian prior of the posture's accuracy.
//
// Frames: optical frame of the earlier and of the later image (frame.h). Units: m, rad, px.
#pragma once

#include <Eigen/Geometry>

#include "vision/flow/ego_motion_rows.h"
#include "vision/image/frame.h"

namespace kaz::vision {

// One of FlowSamples.
struct FlowSample {
  Eigen::Vector2d at, flow;
  double min_inverse_depth, max_inverse_depth;
};

// Standard deviations of the relative pose from the postures, each axis.
struct PostureError {
  double rotation_rad, translation_m;
};

class EgoMotion {
 public:
  EgoMotion(const FrameInfo& before, const FrameInfo& after);

  Eigen::Vector3d ray(double u, double v) const {
    return {(u - camera_.cx) / camera_.fx, (v - camera_.cy) / camera_.fy, 1};
  }
  // Flow (px) of a static point at pixel (u, v): pi(R r + w t) - (u, v) with r the pixel's ray, w the
  // inverse depth (1/m) and pi the projection. False if the point is behind the later camera.
  bool flow(double u, double v, double inverse_depth, Eigen::Vector2d& px) const {
    const Eigen::Vector3d p = later_.linear() * ray(u, v) + inverse_depth * later_.translation();
    if (p.z() < 0.05) return false;
    px = {camera_.fx * p.x() / p.z() + camera_.cx - u, camera_.fy * p.y() / p.z() + camera_.cy - v};
    return true;
  }
  // Transform from the earlier optical frame to the later one: (R, t).
  const Eigen::Isometry3d& later() const { return later_; }

  // Residual (px): from the nearest point of the segment of static flows that the sample's interval of
  // inverse depth maps to, to the measured flow. `epipolar`: unit vector along the segment if that point
  // is inside it, where depth is free; zero if it is an end point. False as flow().
  bool residual(const FlowSample& sample, Eigen::Vector2d& px, Eigen::Vector2d& epipolar) const;
  // The same of many.
  void residuals(const FlowSamples& samples, FlowResiduals& found) const {
    find_residuals(samples, camera_, later_, found);
  }

  struct Correction {
    Eigen::Vector3d rotation_rad{0, 0, 0}, translation_m{0, 0, 0};  // later optical frame
    double spread_px = 0;  // robust standard deviation of the residuals, each axis
  };
  // Refines this ego-motion and returns the correction. With fewer than 50 samples: no correction.
  Correction correct(const FlowSamples& samples, const PostureError& error);

 private:
  CameraModel camera_;
  Eigen::Isometry3d later_;
};

}  // namespace kaz::vision
