// A scene prepared for rendering: one vertex buffer, and pieces that are drawn with one call each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"
#include "sim/render/model/mesh.h"
#include "sim/render/model/texture.h"

namespace kaz::sim {

struct ColoredVertex {
  Vertex vertex;                      // vertex in the frame of the piece
  std::array<std::uint8_t, 4> color;  // RGB codes; alpha is unused
};

struct BoundingSphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0;
};

// A group of visuals with the same frame and texture. A piece has a few hundred triangles, because llvmpipe
// draws larger pieces more slowly.
struct Piece {
  int frame = 0;
  int texture = -1;     // index into SceneModel::textures; -1: no texture
  bool ground = false;  // true for planes; planes are drawn last and cast no shadow
  // Ranges of SceneModel::indices for the fine and the coarse meshes. The coarse meshes are used if the piece
  // is small in the picture. The first `caster_count` indices of the coarse range belong to the visuals that
  // cast shadows. Only these `caster_count` indices are drawn into the shadow map.
  std::uint32_t fine_first = 0, fine_count = 0;
  std::uint32_t coarse_first = 0, coarse_count = 0, caster_count = 0;
  // Bounding sphere, in the frame of the piece.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0;
  // Bounding sphere of each visual that casts a shadow, in the frame of the piece.
  std::vector<BoundingSphere> casters;
  // True if the piece is a ground and all its points lie in one plane. In the frame of the piece, `normal` is
  // the normal of this plane, and `distance` is the distance of this plane from the origin.
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

// Returns Fault::usage with the name of the visual if a shape, mesh file, texture or frame is invalid.
Result<SceneModel> build_scene_model(const Scene& scene);

}  // namespace kaz::sim
