// Vertices of the scene model as arrays of single numbers, textures as words.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/raster/raster_scene.h"

#include <algorithm>

namespace kaz::sim::raster {
namespace {

void resize(Vertices& v, std::size_t size) {
  for (std::vector<float>* list : {&v.x, &v.y, &v.z, &v.u, &v.v, &v.w}) list->resize(size);
  for (auto& list : v.model_normal) list.resize(size);
  for (auto& list : v.normal) list.resize(size);
  v.tint.resize(size);
  v.px.resize(size);
  v.py.resize(size);
  v.outside.resize(size);
}

void put(Vertices& v, std::size_t i, const ColoredVertex& from, float repeats_per_m) {
  v.x[i] = from.vertex.position[0];
  v.y[i] = from.vertex.position[1];
  v.z[i] = from.vertex.position[2];
  v.u[i] = from.vertex.uv[0] * repeats_per_m;
  v.v[i] = from.vertex.uv[1] * repeats_per_m;
  for (std::size_t k = 0; k < 3; ++k) {
    v.model_normal[k][i] = from.vertex.normal[k];
    const float code = static_cast<float>(from.color[k]) / 255.0F;
    v.tint[i][k] = code * code;
  }
}

VertexRange range_of(const SceneModel& model, std::uint32_t first, std::uint32_t count) {
  if (count == 0) return {};
  const auto begin = model.indices.begin() + first;
  const auto [low, high] = std::minmax_element(begin, begin + count);
  return {*low, *high - *low + 1};
}

bool is_grey(const std::vector<std::uint8_t>& rgba) {
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    if (rgba[i] != rgba[i + 1] || rgba[i] != rgba[i + 2]) return false;
  }
  return true;
}

TextureLevels levels_of(const Texture& texture) {
  TextureLevels levels;
  while ((1 << levels.side_bits) < texture.size) ++levels.side_bits;
  levels.last = static_cast<int>(texture.levels.size()) - 1;
  levels.grey = std::all_of(texture.levels.begin(), texture.levels.end(), is_grey);
  std::size_t side = static_cast<std::size_t>(texture.size);
  const std::size_t words = levels.grey ? 1 : 4;
  for (std::size_t i = 0; i < texture.levels.size(); ++i, side /= 2) {
    levels.offset[i] = static_cast<std::int32_t>(levels.words.size() / words);
    const auto at = [&](std::size_t x, std::size_t y, std::size_t channel) -> std::uint32_t {
      return texture.levels[i][(y % side * side + x % side) * 4 + channel];
    };
    for (std::size_t y = 0; y < side; ++y) {
      for (std::size_t x = 0; x < side; ++x) {
        for (std::size_t c = 0; c < words; ++c)
          levels.words.push_back(at(x, y, c) | at(x + 1, y, c) << 8 | at(x, y + 1, c) << 16 |
                                 at(x + 1, y + 1, c) << 24);
      }
    }
  }
  return levels;
}

}  // namespace

RasterScene::RasterScene(SceneModel from) : model(std::move(from)), indices(model.indices.size()) {
  for (const Piece& piece : model.pieces) {
    const double period =
        piece.texture < 0 ? 1 : model.textures[static_cast<std::size_t>(piece.texture)].repeat_m;
    const auto repeats_per_m = static_cast<float>(1 / period);
    ranges.push_back({add(piece.fine_first, piece.fine_count, repeats_per_m),
                      add(piece.coarse_first, piece.coarse_count, repeats_per_m)});
  }
  resize(vertices, own_vertices + kPad);
  for (const Texture& texture : model.textures) textures.push_back(levels_of(texture));
}

VertexRange RasterScene::add(std::uint32_t first, std::uint32_t count, float repeats_per_m) {
  const VertexRange in_model = range_of(model, first, count);
  const auto begin = static_cast<std::uint32_t>(own_vertices);
  own_vertices = (own_vertices + in_model.count + kPad - 1) / kPad * kPad;
  resize(vertices, own_vertices);
  for (std::uint32_t i = 0; i < in_model.count; ++i)
    put(vertices, begin + i, model.vertices[in_model.first + i], repeats_per_m);
  for (std::uint32_t i = first; i < first + count; ++i)
    indices[i] = model.indices[i] - in_model.first + begin;
  return {begin, in_model.count};
}

}  // namespace kaz::sim::raster
