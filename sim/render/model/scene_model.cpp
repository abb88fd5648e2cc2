// Groups the visuals of a scene into pieces by frame and texture.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/model/scene_model.h"

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

// Around the vertices of indices first .. end - 1.
BoundingSphere sphere_around(const SceneModel& model, std::uint32_t first, std::uint32_t end) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  const auto position = [&](std::uint32_t i) {
    const auto& p = model.vertices[model.indices[i]].vertex.position;
    return Eigen::Vector3d(p[0], p[1], p[2]);
  };
  for (std::uint32_t i = first; i < end; ++i) {
    low = low.cwiseMin(position(i));
    high = high.cwiseMax(position(i));
  }
  BoundingSphere sphere{0.5 * (low + high), 0};
  for (std::uint32_t i = first; i < end; ++i)
    sphere.radius = std::max(sphere.radius, (position(i) - sphere.center).norm());
  return sphere;
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
  Mesh coarse;
  int texture;
  bool plane;
  bool caster;
};

Result<std::vector<Prepared>> prepare(const Scene& scene, SceneModel& model) {
  std::vector<Prepared> all;
  std::map<std::string, int> texture_index;
  for (const Visual& visual : scene.visuals) {
    if (visual.frame < 0 || static_cast<std::size_t>(visual.frame) >= scene.frames.size()) {
      return fail(Fault::usage,
                  "visual `" + visual.name + "`: frame " + std::to_string(visual.frame) +
                      ": must be at least 0 and below " + std::to_string(scene.frames.size()) +
                      ", the scene's number of frames");
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
    Mesh coarse = make_mesh(visual.shape, Detail::coarse).value_or(*mesh);
    const bool caster = !plane && extent(*mesh) > kSmallestCaster;
    all.push_back({&visual, std::move(*mesh), std::move(coarse), texture, plane, caster});
  }
  return all;
}

using Group = std::vector<const Prepared*>;

// By frame and texture, in the order of the scene, grounds last.
std::vector<Group> grouped(std::vector<Prepared>& all) {
  const auto key = [](const Prepared& p) {
    return std::make_tuple(p.plane, p.texture, p.visual->frame);
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Prepared& a, const Prepared& b) { return key(a) < key(b); });
  std::vector<Group> groups;
  std::size_t indices = 0;
  for (const Prepared& p : all) {
    if (groups.empty() || key(*groups.back().back()) != key(p) ||
        indices + p.mesh.indices.size() > kLargestPiece) {
      groups.emplace_back();
      indices = 0;
    }
    groups.back().push_back(&p);
    indices += p.mesh.indices.size();
  }
  return groups;
}

// Whether all vertices are in one plane, within the resolution of float.
void find_plane(const SceneModel& model, Piece& piece) {
  const auto at = [&](std::uint32_t index) -> const Vertex& {
    return model.vertices[model.indices[piece.fine_first + index]].vertex;
  };
  if (!piece.ground || piece.fine_count == 0) return;
  const auto vector = [](const std::array<float, 3>& a) {
    return Eigen::Vector3d(a[0], a[1], a[2]);
  };
  piece.normal = vector(at(0).normal).normalized();
  piece.distance = piece.normal.dot(vector(at(0).position));
  piece.flat = true;
  for (std::uint32_t i = 0; i < piece.fine_count; ++i) {
    const Eigen::Vector3d p = vector(at(i).position);
    if (std::abs(piece.normal.dot(p) - piece.distance) > 1e-6 * (1 + p.norm()) ||
        piece.normal.dot(vector(at(i).normal)) < 1 - 1e-6)
      piece.flat = false;
  }
}

Piece add_piece(SceneModel& model, const Group& group) {
  const auto size = [&] { return static_cast<std::uint32_t>(model.indices.size()); };
  Piece piece;
  piece.frame = group[0]->visual->frame;
  piece.texture = group[0]->texture;
  piece.ground = group[0]->plane;
  piece.fine_first = size();
  for (const Prepared* p : group) append(model, *p->visual, p->mesh);
  piece.fine_count = size() - piece.fine_first;
  piece.coarse_first = size();
  for (const bool caster : {true, false}) {
    for (const Prepared* p : group) {
      if (p->caster != caster) continue;
      const std::uint32_t first = size();
      append(model, *p->visual, p->coarse);
      if (caster) piece.casters.push_back(sphere_around(model, first, size()));
    }
    if (caster) piece.caster_count = size() - piece.coarse_first;
  }
  piece.coarse_count = size() - piece.coarse_first;
  const BoundingSphere bounds =
      sphere_around(model, piece.fine_first, piece.fine_first + piece.fine_count);
  piece.center = bounds.center;
  piece.radius = bounds.radius;
  find_plane(model, piece);
  return piece;
}

}  // namespace

Result<SceneModel> build_scene_model(const Scene& scene) {
  SceneModel model;
  model.frames = scene.frames.size();
  Result<std::vector<Prepared>> prepared = prepare(scene, model);
  if (!prepared) return tl::unexpected(prepared.error());
  for (const Group& group : grouped(*prepared)) model.pieces.push_back(add_piece(model, group));
  return model;
}

}  // namespace kaz::sim
