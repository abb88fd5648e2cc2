// A scene prepared for rendering: one vertex buffer, and pieces that are drawn with one call each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"
#include "sim/view/model/mesh.h"
#include "sim/view/model/texture.h"

namespace kaz::sim {

struct ColoredVertex {
  Vertex vertex;                      // in the frame of its piece
  std::array<std::uint8_t, 4> color;  // RGB codes, alpha unused
};

struct BoundingSphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0;
};

// Visuals that share frame and texture, a few hundred triangles. Larger pieces are slower in llvmpipe.
struct Piece {
  int frame = 0;
  int texture = -1;     // index into SceneModel::textures; -1: none
  bool ground = false;  // planes, which are drawn last and cast no shadow
  // Ranges of SceneModel::indices. Coarse meshes serve pieces that are small in the picture. Their first
  // `caster_count` indices, those of large visuals, are also drawn into the shadow map.
  std::uint32_t fine_first = 0, fine_count = 0;
  std::uint32_t coarse_first = 0, coarse_count = 0, caster_count = 0;
  // Bounding sphere, in the frame of the piece.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0;
  std::vector<BoundingSphere> casters;  // around each visual that casts a shadow, in the frame
  // True if the piece is a ground in one plane. Normal and distance from the origin are in the frame.
  bool flat = false;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance = 0;
};

struct SceneModel {
  std::vector<ColoredVertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<Piece> pieces;
  std::vector<Texture> textures;
  std::size_t frames = 0;
};

// Returns Fault::usage, with the visual's name, for an invalid shape, mesh file, texture or frame.
Result<SceneModel> build_scene_model(const Scene& scene);

}  // namespace kaz::sim
