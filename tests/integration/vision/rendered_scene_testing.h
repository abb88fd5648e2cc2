// For tests: renders a floor with boxes by the simulator's eyes, and computes the true depth of pixels.
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

struct TruePixel {
  double depth_m = 0;  // along the optical axis; 0: no surface
  bool floor = false;
};

class RenderedScene {
 public:
  struct Box {
    Eigen::Vector3d middle, size;
  };

  // Boxes and a wall on a floor with this texture. The left eye is 0.3 m above the world's origin and looks
  // along x, `tilt_rad` below the horizon. `width`: of the pictures, px.
  RenderedScene(int width, const std::string& texture, double tilt_rad, bool textured_boxes = false)
      : calibration_(make_calibration(model(width), 2, kEyeBaseline_m)),
        left_(model(width), calibration_, Sensor::Eye::left, 1),
        right_(model(width), calibration_, Sensor::Eye::right, 1),
        rectifier_(calibration_),
        eye_(look_at({0, 0, 0.3}, {std::cos(tilt_rad), 0, 0.3 - std::sin(tilt_rad)})) {
    scene_.add_ground(texture);
    boxes_ = {{{0.45, 0.12, 0.04}, {0.08, 0.10, 0.08}},
              {{0.65, -0.20, 0.06}, {0.10, 0.15, 0.12}},
              {{1.60, 0.00, 0.50}, {0.10, 4.00, 1.00}}};
    for (const Box& b : boxes_)
      scene_.add(Shape::Kind::box, b.size, b.middle, {0.5F, 0.7F, 0.6F},
                 textured_boxes ? "carpet" : "");
  }

  const vision::CameraModel& camera() const { return calibration_.rectified; }
  vision::FrameInfo info() const {
    vision::FrameInfo info;
    info.camera = camera();
    info.posture_known = true;
    info.foot_from_eye = eye_;  // the foot is at the world's origin
    return info;
  }

  // Creates a renderer with the scene.
  std::unique_ptr<Renderer> renderer() const {
    auto renderer = std::move(*maker_of(kDefaultRenderer)());
    EXPECT_TRUE(renderer->set_scene(scene_.scene));
    return renderer;
  }

  // Returns rectified pictures of real eyes, with lenses and the noise of exposure number `exposure`.
  vision::StereoImages take(Renderer& renderer, std::uint64_t exposure) const {
    vision::StereoImages raw, rectified;
    raw.left = sim::take(renderer, scene_.pose, left_, eye_, exposure);
    raw.right = sim::take(renderer, scene_.pose, right_,
                          eye_ * Eigen::Translation3d(kEyeBaseline_m, 0, 0), exposure);
    rectifier_.rectify(raw, rectified);
    return rectified;
  }

  // Returns the picture of an ideal left eye, to find texture.
  vision::Image ideal_picture(Renderer& renderer) const {
    View view;
    view.camera = camera();
    view.world_from_optical = eye_;
    vision::Image picture;
    EXPECT_TRUE(renderer.render(scene_.pose, view, picture));
    return picture;
  }

  // Returns the true surface at (u, v) of the rectified left picture.
  TruePixel truth(double u, double v) const {
    return along(eye_.translation(), eye_.linear() * camera().ray(u, v));
  }

  bool seen_by_both(double u, double v) const {
    const vision::CameraModel& c = camera();
    const double depth = truth(u, v).depth_m;
    if (depth <= 0) return false;
    const Eigen::Vector3d at = eye_ * (depth * c.ray(u, v));
    const Eigen::Vector3d from = eye_ * Eigen::Vector3d(c.baseline_m, 0, 0);
    return std::abs(along(from, at - from).depth_m - 1) < 1e-6;
  }

 private:
  static EyeModel model(int width) {
    EyeModel m;
    m.width = width;
    m.height = width * 3 / 4;
    return m;
  }

  // Returns the nearest surface along a ray. Its depth_m is in lengths of `ray`. So it is a depth if the ray
  // has z = 1 in the optical frame.
  TruePixel along(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    TruePixel best;
    if (ray.z() < 0) {
      best.depth_m = -from.z() / ray.z();
      const Eigen::Vector3d at = from + best.depth_m * ray;
      best.floor = std::abs(at.x()) < 3 && std::abs(at.y()) < 3;
      if (!best.floor) best.depth_m = 0;
    }
    for (const Box& b : boxes_) {
      const Eigen::Array3d one = (b.middle - 0.5 * b.size - from).array() / ray.array();
      const Eigen::Array3d two = (b.middle + 0.5 * b.size - from).array() / ray.array();
      const double enter = one.min(two).maxCoeff(), leave = one.max(two).minCoeff();
      if (enter > 0 && enter < leave && (best.depth_m == 0 || enter < best.depth_m))
        best = {enter, false};
    }
    return best;
  }

  vision::StereoCalibration calibration_;
  Sensor left_, right_;
  vision::Rectifier rectifier_;
  Eigen::Isometry3d eye_;
  TestScene scene_;
  std::vector<Box> boxes_;
};

}  // namespace kaz::sim
