// A scene prepared for the rasterizer: arrays of vertices and textures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/view/model/scene_model.h"
#include "sim/view/raster/kernels.h"

namespace kaz::sim::raster {

// Each range begins at a multiple of kPad, so that vectors may write beyond its end.
struct PieceVertices {
  VertexRange fine, coarse;
};

struct RasterScene {
  explicit RasterScene(SceneModel from);

  SceneModel model;
  std::vector<std::uint32_t> indices;  // as model.indices, but into `vertices`
  Vertices vertices;
  std::size_t own_vertices = 0;       // number of scene vertices; clipping appends others
  std::vector<PieceVertices> ranges;  // by piece
  std::vector<TextureLevels> textures;

 private:
  // Copies the vertices of a range of indices and returns their range in `vertices`.
  VertexRange add(std::uint32_t first, std::uint32_t count, float repeats_per_m);
};

}  // namespace kaz::sim::raster
