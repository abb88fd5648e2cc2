// Camera images, and the frame information of an image.
// SPDX-License-Identifier: Apache-2.0
//
// Every vision result contains the frame information of its image. Regardless of latency, positions in the
// result are relative to the camera pose at the exposure, not at the delivery of the result.
//
// Optical frame: x right, y down, z forward, origin at the lens. Foot frame: x forward, y left, z up, origin
// at the sole of the supporting foot. Units: m, rad, s. Source: paper, section 4.1.
#pragma once

#include <array>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "shared/base/time.hpp"
#include "shared/picture/picture.h"

namespace kaz::vision {

// Pinhole camera, pixel centers at integer coordinates: u = fx x/z + cx, v = fy y/z + cy. Focal lengths and
// centers are in px.
struct CameraModel {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double baseline_m = 0;  // position of the right lens along +x of the left optical frame

  // Returns the direction (x/z, y/z, 1) of the ray through pixel (u, v).
  Eigen::Vector3d ray(double u, double v) const { return {(u - cx) / fx, (v - cy) / fy, 1}; }
  // Returns the pixel of a point in the optical frame. Requires z > 0.
  Eigen::Vector2d pixel(const Eigen::Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }
};

using picture::Image;

struct StereoImages {
  Image left, right;
};

// Time, camera and posture of an image.
struct FrameInfo {
  std::uint64_t sequence = 0;
  Time exposure{};                // middle of the exposure
  CameraModel camera;             // camera model of the left eye
  bool posture_known = false;     // false if the board's state at `exposure` is unknown
  std::vector<double> joint_rad;  // measured angles at `exposure`, by joint number
  // Transform from the left optical frame to the foot frame.
  Eigen::Isometry3d foot_from_eye = Eigen::Isometry3d::Identity();
};

// A stereo pair from a camera. The pixels may still be in transfer; `images.get()` waits until all pixels
// have arrived.
struct StereoPair {
  FrameInfo info;
  std::shared_future<std::shared_ptr<const StereoImages>> images;
};

// Creates a pair from images in memory, e.g. from files.
StereoPair stereo_pair(FrameInfo info, StereoImages images);

// A source of stereo pairs: simulated, published by another process, V4L2, or files.
class Camera {
 public:
  virtual ~Camera() = default;
  virtual const CameraModel& model() const = 0;
  // Returns the next pair that has reached the host, oldest first, or nullopt if no pair is waiting. Never
  // blocks. An error is final: after an error, poll() returns no more pairs. The error's message contains
  // the reason.
  virtual Result<std::optional<StereoPair>> poll() = 0;
};

}  // namespace kaz::vision
