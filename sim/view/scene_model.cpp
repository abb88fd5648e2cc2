// Groups the visuals of a scene into pieces by frame and texture.
// SPDX-License-Identifier: Apache-2.0
#include "sim/view/scene_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace kaz::sim {

namespace {

constexpr std::uint32_t kLargestPiece = 3 * 600;  // indices
constexpr double kSmallestCaster = 0.030;         // m, largest side of its box

std::uint8_t code(float value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0F, 1.0F) * 255.0F + 0.5F);
}

void append(SceneModel& model, const Visual& visual, const Mesh& mesh) {
  const auto base = static_cast<std::uint32_t>(model.vertices.size());
  const std::array<std::uint8_t, 4> color{code(visual.color.r), code(visual.color.g),
                                          code(visual.color.b), 255};
  for (const Vertex& v : mesh.vertices) {
    const Eigen::Vector3d p =
        visual.in_frame * Eigen::Vector3d(v.position[0], v.position[1], v.position[2]);
    const Eigen::Vector3d n =
        visual.in_frame.linear() * Eigen::Vector3d(v.normal[0], v.normal[1], v.normal[2]);
    model.vertices.push_back(
        {{{static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())},
          {static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z())},
          v.uv},
         color});
  }
  for (const std::uint32_t index : mesh.indices) model.indices.push_back(base + index);
}

void bound(const SceneModel& model, Piece& piece) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  const auto position = [&](std::uint32_t i) {
    const auto& p = model.vertices[model.indices[piece.first_index + i]].vertex.position;
    return Eigen::Vector3d(p[0], p[1], p[2]);
  };
  for (std::uint32_t i = 0; i < piece.index_count; ++i) {
    low = low.cwiseMin(position(i));
    high = high.cwiseMax(position(i));
  }
  piece.center = 0.5 * (low + high);
  piece.radius = 0;
  for (std::uint32_t i = 0; i < piece.index_count; ++i) {
    piece.radius = std::max(piece.radius, (position(i) - piece.center).norm());
  }
}

double extent(const Mesh& mesh) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  for (const Vertex& v : mesh.vertices) {
    const Eigen::Vector3d p(v.position[0], v.position[1], v.position[2]);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).maxCoeff();
}

struct Prepared {
  const Visual* visual;
  Mesh mesh;
  Mesh caster;  // empty: casts no shadow
  int texture;
  bool plane;
};

Result<std::vector<Prepared>> prepare(const Scene& scene, SceneModel& model) {
  std::vector<Prepared> all;
  std::map<std::string, int> texture_index;
  for (const Visual& visual : scene.visuals) {
    if (visual.frame < 0 || static_cast<std::size_t>(visual.frame) >= scene.frames.size()) {
      return fail(Fault::usage, "visual `" + visual.name + "` is fixed to frame " +
                                    std::to_string(visual.frame) + " of a scene that has " +
                                    std::to_string(scene.frames.size()));
    }
    Result<Mesh> mesh = make_mesh(visual.shape);
    if (!mesh) {
      return fail(mesh.error().fault, "visual `" + visual.name + "`: " + mesh.error().message);
    }
    int texture = -1;
    if (!visual.texture.empty()) {
      const auto [at, fresh] =
          texture_index.try_emplace(visual.texture, static_cast<int>(model.textures.size()));
      if (fresh) {
        Result<Texture> made = make_texture(visual.texture);
        if (!made) {
          return fail(made.error().fault, "visual `" + visual.name + "`: " + made.error().message);
        }
        model.textures.push_back(std::move(*made));
      }
      texture = at->second;
    }
    const bool plane = visual.shape.kind == Shape::Kind::plane;
    Mesh caster;
    if (!plane && extent(*mesh) > kSmallestCaster) {
      Result<Mesh> coarse = make_mesh(visual.shape, Detail::coarse);
      if (coarse) caster = std::move(*coarse);
    }
    all.push_back({&visual, std::move(*mesh), std::move(caster), texture, plane});
  }
  return all;
}

// Adds a mesh to the last piece if that has the same key and room, else to a new one.
template <class Key>
class PieceBuilder {
 public:
  PieceBuilder(SceneModel& model, std::vector<Piece>& pieces) : model_(model), pieces_(pieces) {}

  void add(const Key& key, const Prepared& p, const Mesh& mesh) {
    const auto count = static_cast<std::uint32_t>(mesh.indices.size());
    if (count == 0) return;
    if (pieces_.empty() || key != key_ || pieces_.back().index_count + count > kLargestPiece) {
      Piece piece;
      piece.frame = p.visual->frame;
      piece.texture = p.texture;
      piece.ground = p.plane;
      piece.first_index = static_cast<std::uint32_t>(model_.indices.size());
      pieces_.push_back(piece);
      key_ = key;
    }
    append(model_, *p.visual, mesh);
    pieces_.back().index_count += count;
  }

 private:
  SceneModel& model_;
  std::vector<Piece>& pieces_;
  Key key_{};
};

}  // namespace

Result<SceneModel> build_scene_model(const Scene& scene) {
  SceneModel model;
  model.frames = scene.frames.size();
  Result<std::vector<Prepared>> prepared = prepare(scene, model);
  if (!prepared) return tl::unexpected(prepared.error());
  using Key = std::tuple<bool, int, int>;
  const auto key = [](const Prepared& p) { return Key(p.plane, p.texture, p.visual->frame); };
  std::stable_sort(prepared->begin(), prepared->end(),
                   [&](const Prepared& a, const Prepared& b) { return key(a) < key(b); });
  PieceBuilder<Key> pieces(model, model.pieces);
  for (const Prepared& p : *prepared) pieces.add(key(p), p, p.mesh);
  std::stable_sort(prepared->begin(), prepared->end(), [](const Prepared& a, const Prepared& b) {
    return a.visual->frame < b.visual->frame;
  });
  PieceBuilder<int> casters(model, model.casters);
  for (const Prepared& p : *prepared) casters.add(p.visual->frame, p, p.caster);
  for (Piece& piece : model.pieces) bound(model, piece);
  for (Piece& piece : model.casters) bound(model, piece);
  return model;
}

}  // namespace kaz::sim
