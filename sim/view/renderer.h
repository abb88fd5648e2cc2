// Pictures of a scene. One interface, so that another way to get an off-screen OpenGL context (EGL
// surfaceless) can stand beside OSMesa.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "sim/body/scene.h"

namespace kaz::sim {

// 8-bit RGB, rows from top to bottom, no padding.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

// Pinhole: pixel (u, v) = (fx x/z + cx, fy y/z + cy) in the optical frame (x right, y down, z forward);
// pixel centres at integer coordinates.
struct Pinhole {
  int width = 320, height = 240;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  static Pinhole from_horizontal_view(int width, int height, double horizontal_rad);
};

struct View {
  Pinhole camera;
  Eigen::Isometry3d world_from_optical = Eigen::Isometry3d::Identity();
};

class Renderer {
 public:
  virtual ~Renderer() = default;
  // Uploads shapes and textures; once, before the first picture.
  virtual Result<void> set_scene(const Scene& scene) = 0;
  // Same scene, pose and view: same bytes. Call from one thread only (the one that made the renderer).
  virtual Result<void> render(const ScenePose& pose, const View& view, Picture& picture) = 0;
};

// Off-screen Mesa (llvmpipe). Fails with a reason where the context cannot be made.
Result<std::unique_ptr<Renderer>> make_osmesa_renderer();

}  // namespace kaz::sim
