// Interface for rendering pictures of a scene with the robot's cameras or an observer's camera.
// SPDX-License-Identifier: Apache-2.0
//
// Implementations: OpenGL (sim/render/gl) and the project's own rasterizer (sim/render/raster).
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"
#include "vision/image/frame.h"

namespace kaz::sim {

// Part of a picture: the columns `left .. right - 1` of the rows `top .. bottom - 1`.
struct PicturePart {
  int left = 0, top = 0, right = 0, bottom = 0;
};

struct View {
  vision::CameraModel camera;  // without use of the baseline
  Eigen::Isometry3d world_from_optical = Eigen::Isometry3d::Identity();
  // Number n of samples along each axis of a pixel, 1..4. Each pixel is computed from n x n samples. Cameras
  // use n = 1. Pictures for documentation use n = 2 for smooth edges.
  int samples_per_axis = 1;
  Light light = {};  // light of the scene; does not affect the sky in the background
  // Required part of the picture. Pixels outside this part may have any codes. nullopt: the whole picture is
  // required.
  std::optional<PicturePart> part = {};
};

class Renderer {
 public:
  virtual ~Renderer() = default;
  // Builds the meshes. Call this function once, before the first picture. Returns Fault::usage if a mesh file
  // cannot be read, or if a visual refers to an unknown texture or frame.
  virtual Result<void> set_scene(const Scene& scene) = 0;
  // Draws a picture. The same scene, pose and view always result in the same bytes. Returns Fault::usage for
  // an invalid view. The first call starts OpenGL (about 0.3 s) and returns Fault::environment if OpenGL is
  // not available. Any thread may call render(). Two calls of render() must not run at the same time. Shadow
  // maps are reused if the pose has not changed. Therefore render the left and the right picture of a pair
  // directly one after the other.
  virtual Result<void> render(const ScenePose& pose, const View& view, vision::Image& picture) = 0;
};

// Makes a renderer with off-screen Mesa (llvmpipe), which rasterizes in the calling thread. `backend` is
// "osmesa" or "egl" (without a surface). If `backend` is empty, osmesa is used if available, otherwise egl.
// The function sets Mesa's environment variables for the process, so that pictures do not depend on the
// user's environment. Call this function before starting threads that read the environment. If OpenGL is not
// available, make_renderer() succeeds, and render() returns the error.
Result<std::unique_ptr<Renderer>> make_renderer(const std::string& backend);
// Like make_renderer(), but the environment variable KAZ_OPENGL selects the backend.
Result<std::unique_ptr<Renderer>> make_opengl_renderer();

// Makes the project's own rasterizer with the processor's widest vectors. All vector widths give the same
// bytes. This function never fails. The function returns a Result because the type RendererMaker requires a
// Result.
Result<std::unique_ptr<Renderer>> make_raster_renderer();

}  // namespace kaz::sim
