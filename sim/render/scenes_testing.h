// For tests and benchmarks: small scenes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>

#include "sim/render/camera.h"

namespace kaz::sim {

inline constexpr double kEyeView_rad = 80.0 * 3.14159265358979323846 / 180.0;
inline constexpr double kEyeBaseline_m = 0.040;
inline constexpr Rgb kRedBall{0.85F, 0.08F, 0.06F};

// A scene under construction, with its pose. Frame 0 is the world.
struct TestScene {
  Scene scene;
  ScenePose pose;

  TestScene() {
    scene.frames.push_back("world");
    pose.frames.push_back(Eigen::Isometry3d::Identity());
  }

  // Adds a frame and a visual in this frame. `at` is the position of the frame in the world frame, m. Returns
  // the number of the frame.
  int add(Shape::Kind kind, const Eigen::Vector3d& size, const Eigen::Vector3d& at,
          const Rgb& color, const std::string& texture = "") {
    Visual visual;
    visual.name = "visual" + std::to_string(scene.visuals.size());
    visual.frame = static_cast<int>(scene.frames.size());
    visual.shape.kind = kind;
    visual.shape.size = size;
    visual.color = color;
    visual.texture = texture;
    scene.visuals.push_back(visual);
    scene.frames.push_back(visual.name);
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    frame.translation() = at;
    pose.frames.push_back(frame);
    return visual.frame;
  }

  void add_ground(const std::string& texture) {
    const Rgb color = texture == "wood"     ? Rgb{0.80F, 0.58F, 0.36F}
                      : texture == "carpet" ? Rgb{0.42F, 0.50F, 0.58F}
                                            : Rgb{0.86F, 0.86F, 0.84F};
    add(Shape::Kind::plane, {6, 6, 0}, {0, 0, 0}, color, texture);
  }

  int add_ball(const Eigen::Vector3d& at, const Rgb& color = kRedBall, double radius = 0.02) {
    return add(Shape::Kind::sphere, {radius, 0, 0}, at, color);
  }
};

// Returns a scene with twenty objects and a ball on a checkered ground: 5,200 triangles in 22 pieces.
inline TestScene table_scene() {
  TestScene s;
  s.add_ground("checker");
  s.add_ball({0.40, 0.05, 0.02});
  for (int i = 0; i < 20; ++i) {
    const double x = 0.45 + 0.11 * (i % 5), y = -0.45 + 0.22 * (i / 5);
    const float hue = 0.03F * static_cast<float>(i);
    if (i % 5 == 4) {
      s.add(Shape::Kind::capsule, {0.02, 0.06, 0}, {x, y, 0.05}, {0.3F + hue, 0.5F, 0.8F - hue});
    } else if (i % 5 == 2) {
      s.add(Shape::Kind::cylinder, {0.025, 0.06, 0}, {x, y, 0.03}, {0.3F, 0.3F + hue, 0.5F});
    } else {
      s.add(Shape::Kind::box, {0.04, 0.05, 0.06}, {x, y, 0.03}, {0.7F, 0.75F - hue, 0.3F + hue});
    }
  }
  return s;
}

// Returns the view from an eye of the standing robot. The eye is 0.3 m above the ground and is tilted down by
// `tilt_rad`.
inline View eye_view(int width = 320, double tilt_rad = 0.6) {
  View view;
  view.camera = camera_of_view(width, width * 3 / 4, kEyeView_rad);
  view.world_from_optical = look_at({0, 0, 0.3}, {std::cos(tilt_rad), 0, 0.3 - std::sin(tilt_rad)});
  return view;
}

// Returns the pixel coordinates of a point that is given in the world frame.
inline Eigen::Vector2d project(const View& view, const Eigen::Vector3d& world) {
  return view.camera.pixel(view.world_from_optical.inverse() * world);
}

}  // namespace kaz::sim
