// Draws a scene into the current framebuffer with OpenGL 3.3.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "sim/render/gl/gl_program.h"
#include "sim/render/gl/shaders.h"
#include "sim/render/model/projection.h"
#include "sim/render/model/scene_model.h"

namespace kaz::sim {

// The OpenGL context must be current in every call. The OpenGL objects of a GlScene are freed when the
// context is destroyed.
class GlScene {
 public:
  // `gl` and `model` must outlive the GlScene.
  static Result<GlScene> create(const Gl& gl, const SceneModel& model);

  // Draws into `framebuffer`. The width and the height of the framebuffer must be `samples_per_axis` times
  // the width and the height of the picture.
  void draw(const ScenePose& pose, const View& view, GLuint framebuffer);

 private:
  GlScene(const Gl& gl, const SceneModel& model) : gl_(&gl), model_(&model) {}

  struct Surface {
    GlProgram program;
    int world_from_model = -1;
  };

  struct ShadowMap {
    int texels = 0;
    GLuint framebuffer = 0, texture = 0;
    ShadowView view{};
    // Poses of the frames at the time when the map was drawn. Empty if the map was never drawn.
    std::vector<Eigen::Isometry3d> pose;
    Eigen::Vector3d to_key = Eigen::Vector3d::Zero();
  };

  // State of the current draw().
  struct Frame {
    const ScenePose& pose;
    const View& view;
    const ShadowMap& map;
    Eigen::Matrix4d clip_from_world;
    const Surface* in_use = nullptr;
  };

  void upload_geometry();
  void upload_textures();
  Result<void> make_shadow_map(int texels);
  Result<void> build_programs();
  void draw_shadow_map(const ScenePose& pose, const Eigen::Vector3d& to_key, ShadowMap& map);
  void draw_surfaces(Frame& frame);
  const Surface& surface(const Piece& piece, Shadow shadow) const {
    return surfaces_[2 * static_cast<std::size_t>(shadow) + (piece.texture >= 0 ? 1 : 0)];
  }
  void use(const Surface& surface, const Piece& piece, Frame& frame);
  void draw_ground(const Piece& piece, Frame& frame);
  void draw_triangles(std::uint32_t first_index, std::uint32_t count) const;

  const Gl* gl_;
  const SceneModel* model_;
  GLuint vertex_array_ = 0, empty_vertex_array_ = 0;
  std::vector<GLuint> textures_;

  // A shader program for each combination of surface (plain or textured) and kind of shadow.
  std::array<Surface, 6> surfaces_;
  GlProgram depth_, background_;
  // Two maps: the first is used for pictures of the eyes, the second for supersampled pictures.
  std::vector<ShadowMap> shadow_maps_;
};

}  // namespace kaz::sim
