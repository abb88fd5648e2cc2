// Renders pictures of a scene, from the robot's cameras or an observer's.
// SPDX-License-Identifier: Apache-2.0
//
// An interface: OpenGL (sim/view/gl), or our rasteriser (sim/view/raster).
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

// Pinhole: pixel (u, v) = (fx x/z + cx, fy y/z + cy) in the optical frame (x right, y down, z
// forward); pixel centres at integer coordinates.
struct Pinhole {
  int width = 320, height = 240;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  static Pinhole from_horizontal_view(int width, int height, double horizontal_rad);
};

// Columns left .. right - 1 of rows top .. bottom - 1.
struct PicturePart {
  int left = 0, top = 0, right = 0, bottom = 0;
};

struct View {
  Pinhole camera;
  Eigen::Isometry3d world_from_optical = Eigen::Isometry3d::Identity();
  // n x n samples a pixel, 1..4. A camera's picture takes 1; one for documentation 2 (smooth
  // edges).
  int samples_per_axis = 1;
  Light light = {};  // the sky in the background stays as it is
  // What is needed of the picture; renderers may leave any codes in the rest. None: all of it.
  std::optional<PicturePart> part = {};
};

class Renderer {
 public:
  virtual ~Renderer() = default;
  // Builds meshes; once, before the first picture. Fails where a mesh file cannot be read or a
  // visual names a texture or frame that does not exist.
  virtual Result<void> set_scene(const Scene& scene) = 0;
  // Deterministic: same scene, pose and view, same bytes. With OpenGL the first call starts it (some 0.3 s);
  // error: why it is not available. Calls may come from any thread, one at a time. Shadows and the like are
  // kept from one call to the next: draw the eyes of a pair one after the other.
  virtual Result<void> render(const ScenePose& pose, const View& view, Picture& picture) = 0;
};

// Off-screen Mesa (llvmpipe), rasterising in the calling thread. `backend`: "osmesa", "egl" (without a
// surface), or empty for the first of these that starts. Sets Mesa's environment variables for the process,
// so that pictures do not depend on the user's: call it before starting threads that read the environment.
// Whether OpenGL is available is known only after the first picture.
Result<std::unique_ptr<Renderer>> make_renderer(const std::string& backend);
// OpenGL with the backend that the environment variable KAZ_OPENGL names.
Result<std::unique_ptr<Renderer>> make_opengl_renderer();

// Our rasteriser, with the widest vectors that the processor has: the same bytes with all of them. It never
// fails, but has the others' type.
Result<std::unique_ptr<Renderer>> make_raster_renderer();

}  // namespace kaz::sim
