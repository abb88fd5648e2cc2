// Meshes of a shape: dispatch by kind.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/model/mesh.h"

#include "sim/body/description/mesh_file.h"

namespace kaz::sim {

namespace {

std::array<float, 3> to_floats(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

}  // namespace

std::uint32_t Mesh::add(const Eigen::Vector3d& position, const Eigen::Vector3d& normal, double u,
                        double v) {
  vertices.push_back(
      {to_floats(position), to_floats(normal), {static_cast<float>(u), static_cast<float>(v)}});
  return static_cast<std::uint32_t>(vertices.size() - 1);
}

void Mesh::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  indices.insert(indices.end(), {a, b, c});
}

void Mesh::quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  indices.insert(indices.end(), {a, b, c, a, c, d});
}

Result<Mesh> load_mesh(const std::string& path, const Eigen::Vector3d& scale) {
  const auto triangles = KAZ_TRY(read_mesh(path, scale));
  Mesh mesh;
  for (std::size_t i = 0; i < triangles.corners.size(); ++i) {
    const Eigen::Vector3d& p = triangles.corners[i];
    mesh.indices.push_back(mesh.add(p, triangles.normals[i], p.x(), p.y()));
  }
  return mesh;
}

Result<Mesh> make_mesh(const Shape& shape, Detail detail) {
  const Eigen::Vector3d& s = shape.size;
  const int numbers = shape.kind == Shape::Kind::sphere                                   ? 1
                      : shape.kind == Shape::Kind::box || shape.kind == Shape::Kind::mesh ? 3
                                                                                          : 2;
  for (int i = 0; i < numbers; ++i) {
    const double size = shape.kind == Shape::Kind::mesh ? std::abs(s[i]) : s[i];
    if (size > 0 && size < 1e4) continue;
    return fail(Fault::usage,
                "each size of the shape must be positive and below 10 km: correct the file");
  }
  switch (shape.kind) {
    case Shape::Kind::box:
      return box_mesh(s, detail);
    case Shape::Kind::cylinder:
      return cylinder_mesh(s.x(), s.y(), detail);
    case Shape::Kind::capsule:
      return capsule_mesh(s.x(), s.y(), detail);
    case Shape::Kind::sphere:
      return sphere_mesh(s.x(), detail);
    case Shape::Kind::plane:
      return plane_mesh(s.x(), s.y());
    case Shape::Kind::mesh:
      return load_mesh(shape.mesh_path, s);
    case Shape::Kind::hull:  // only collides
      break;
  }
  return fail(Fault::usage, "a visual has a shape of unknown kind");
}

}  // namespace kaz::sim
