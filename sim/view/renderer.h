// Interface for rendering pictures of a scene, from the robot's cameras or an observer's.
// SPDX-License-Identifier: Apache-2.0
//
// Implementations: OpenGL (sim/view/gl) and our rasterizer (sim/view/raster).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"

namespace kaz::sim {

// 8-bit RGB, rows from top to bottom, no padding.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

// Pinhole camera: pixel (u, v) = (fx x/z + cx, fy y/z + cy) in the optical frame (x right, y down, z
// forward). Pixel centers are at integer coordinates.
struct Pinhole {
  int width = 320, height = 240;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  // Makes a centered camera with square pixels.
  static Pinhole from_horizontal_view(int width, int height, double horizontal_rad);
};

// Columns left .. right - 1 of rows top .. bottom - 1.
struct PicturePart {
  int left = 0, top = 0, right = 0, bottom = 0;
};

struct View {
  Pinhole camera;
  Eigen::Isometry3d world_from_optical = Eigen::Isometry3d::Identity();
  // n x n samples per pixel, 1..4. Cameras use 1, pictures for documentation 2 (smooth edges).
  int samples_per_axis = 1;
  Light light = {};  // does not change the sky in the background
  // Required part of the picture; renderers may leave any codes in the rest. Empty: the whole picture.
  std::optional<PicturePart> part = {};
};

class Renderer {
 public:
  virtual ~Renderer() = default;
  // Builds the meshes. Call it once, before the first picture. Returns Fault::usage if a mesh file cannot be
  // read, or if a texture or frame of a visual does not exist.
  virtual Result<void> set_scene(const Scene& scene) = 0;
  // Draws a picture. Deterministic: the same scene, pose and view give the same bytes. Returns Fault::usage
  // for an invalid view. The first call starts OpenGL (about 0.3 s) and returns Fault::environment if it is
  // not available. Callable from any thread, but not concurrently. Shadow maps are reused if the pose is
  // the same: draw both eyes of a pair in succession.
  virtual Result<void> render(const ScenePose& pose, const View& view, Picture& picture) = 0;
};

// Makes a renderer with off-screen Mesa (llvmpipe), which rasterizes in the calling thread. `backend` is
// "osmesa", "egl" (without a surface), or empty for the first of these that starts. Sets Mesa's environment
// variables for the process, so that pictures do not depend on the user's. Call it before starting threads
// that read the environment. An unavailable OpenGL is reported by the first picture only.
Result<std::unique_ptr<Renderer>> make_renderer(const std::string& backend);
// As make_renderer(), with the backend of the environment variable KAZ_OPENGL.
Result<std::unique_ptr<Renderer>> make_opengl_renderer();

// Makes our rasterizer with the processor's widest vectors; all widths give the same bytes. It never fails
// and returns a Result only to fit RendererMaker.
Result<std::unique_ptr<Renderer>> make_raster_renderer();

}  // namespace kaz::sim
