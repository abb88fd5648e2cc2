// A scene prepared for the rasterizer: arrays of vertices and textures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/render/model/scene_model.h"
#include "sim/render/raster/kernels.h"

namespace kaz::sim::raster {

// Vertices of a piece. Each range begins at a multiple of kPad. Therefore vector instructions may write
// beyond the end of a range.
struct PieceVertices {
  VertexRange fine, coarse;
};

struct RasterScene {
  explicit RasterScene(SceneModel from);

  SceneModel model;
  std::vector<std::uint32_t> indices;  // model.indices, converted to indices into `vertices`
  Vertices vertices;
  std::size_t own_vertices = 0;  // number of vertices of the scene; clipping appends more vertices
  std::vector<PieceVertices> ranges;  // ranges of vertices of each piece
  std::vector<TextureLevels> textures;

 private:
  // Copies the vertices of a mesh to the end of `vertices`. `first` and `count` select the mesh's part of
  // `model.indices`. Returns the range of the copies in `vertices`.
  VertexRange add(std::uint32_t first, std::uint32_t count, float repeats_per_m);
};

}  // namespace kaz::sim::raster
