// Ego-motion of the camera between two images: predicted from the postures, refined with the optical flow.
// Internal to vision/.
// SPDX-License-Identifier: Apache-2.0
//
// The camera pose is computed from the joint angles and therefore has errors. Causes are noise and
// quantization of the potentiometers, backlash, and sway of the soles. These errors cause several px of flow
// over the whole image, whereas an independently moving object affects only a part of the image. Therefore,
// one small rigid motion xi = (rotation, translation) is fitted to the flow of the whole image and corrects
// the pose. The method is iteratively reweighted least squares (Gauss-Newton). The weights are Tukey's
// biweight with c = 4.685, scaled by the median residual. A Gaussian prior on xi represents the accuracy of
// the posture.
//
// Frames: optical frames of the earlier and the later image (frame.h). Units: m, rad, px.
#pragma once

#include <Eigen/Geometry>

#include "vision/flow/ego_motion_rows.h"
#include "vision/image/frame.h"

namespace kaz::vision {

// One entry of FlowSamples: pixel and flow (px), bounds of the inverse depth (1/m).
struct FlowSample {
  Eigen::Vector2d at, flow;
  double min_inverse_depth, max_inverse_depth;
};

// Standard deviations (per axis) of the errors of the ego-motion that is computed from the postures.
struct PostureError {
  double rotation_rad, translation_m;
};

class EgoMotion {
 public:
  EgoMotion(const FrameInfo& before, const FrameInfo& after);

  Eigen::Vector3d ray(double u, double v) const { return camera_.ray(u, v); }
  // Computes the flow (px) of a static point at pixel (u, v): project(R r + w t) - (u, v). In this formula, r
  // is the ray of the pixel, w is the inverse depth (1/m), and later() returns the transform (R, t). The
  // function project() is the pinhole projection to pixels. Returns false if the later depth of the point is
  // negative, or less than 5 % of the earlier depth.
  bool flow(double u, double v, double inverse_depth, Eigen::Vector2d& px) const {
    const Eigen::Vector3d p = later_.linear() * ray(u, v) + inverse_depth * later_.translation();
    if (p.z() < 0.05) return false;
    px = camera_.pixel(p) - Eigen::Vector2d(u, v);
    return true;
  }
  // Returns the transform (R, t) from the earlier optical frame to the later optical frame.
  const Eigen::Isometry3d& later() const { return later_; }

  // Computes the residual (px) of a sample. For the sample's interval of inverse depth, the possible flows of
  // a static point form a line segment. The residual is the vector from the nearest point of this line
  // segment to the measured flow. If the nearest point is an end of the segment, `epipolar` becomes zero.
  // Otherwise, `epipolar` becomes the unit vector along the segment. A flow error along the segment looks
  // like a change of depth. Returns false if flow() returns false for an end of the interval.
  bool residual(const FlowSample& sample, Eigen::Vector2d& px, Eigen::Vector2d& epipolar) const;
  // Computes residual() for all samples.
  void residuals(const FlowSamples& samples, FlowResiduals& found) const {
    find_residuals(samples, camera_, later_, found);
  }

  struct Correction {
    Eigen::Vector3d rotation_rad{0, 0, 0}, translation_m{0, 0, 0};  // in the later optical frame
    double spread_px = 0;  // robust standard deviation of the residuals, per axis
  };
  // Refines this ego-motion and returns the correction. The correction is zero if there are fewer than 50
  // samples.
  Correction correct(const FlowSamples& samples, const PostureError& error);

 private:
  CameraModel camera_;
  Eigen::Isometry3d later_;
};

}  // namespace kaz::vision
