// Boxes with bevelled edges, and planes.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/render/model/mesh.h"

namespace kaz::sim {

namespace {

double sign_of_bit(int bits, int bit) {
  return (bits >> bit & 1) != 0 ? 1.0 : -1.0;
}

// The 24 vertices of a bevelled box: each corner (bits x, y, z: 1 is the positive side) has one for
// each of the three faces that meet there.
struct BoxVertices {
  std::array<std::array<std::uint32_t, 3>, 8> of;  // [corner][axis of the face]
};

BoxVertices add_box_vertices(Mesh& mesh, const Eigen::Vector3d& half, double bevel) {
  BoxVertices vertices{};
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign(sign_of_bit(corner, 0), sign_of_bit(corner, 1),
                               sign_of_bit(corner, 2));
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d p = sign.cwiseProduct(half - Eigen::Vector3d::Constant(bevel));
      p[axis] = sign[axis] * half[axis];
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      normal[axis] = sign[axis];
      const double u = axis == 0 ? p.y() : p.x();
      const double v = axis == 2 ? p.y() : p.z();
      vertices.of[static_cast<std::size_t>(corner)][static_cast<std::size_t>(axis)] =
          mesh.add(p, normal, u, v);
    }
  }
  return vertices;
}

// Adds the quad a, b, c, d with the winding order for the outward direction `outward`.
void quad_facing(Mesh& mesh, std::array<std::uint32_t, 4> q, const Eigen::Vector3d& outward) {
  const auto at = [&](std::uint32_t i) {
    const auto& p = mesh.vertices[i].position;
    return Eigen::Vector3d(p[0], p[1], p[2]);
  };
  const Eigen::Vector3d normal = (at(q[2]) - at(q[0])).cross(at(q[3]) - at(q[1]));
  if (normal.dot(outward) < 0) std::swap(q[1], q[3]);
  mesh.quad(q[0], q[1], q[2], q[3]);
}

}  // namespace

Mesh box_mesh(const Eigen::Vector3d& lengths, Detail detail) {
  constexpr double kLargestBevel = 0.002;
  Mesh mesh;
  const bool fine = detail == Detail::fine;
  const double bevel = fine ? std::min(kLargestBevel, 0.12 * lengths.minCoeff()) : 0;
  const auto v = add_box_vertices(mesh, 0.5 * lengths, bevel).of;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned a = 1U << (axis + 1) % 3, b = 1U << (axis + 2) % 3, self = 1U << axis;
    for (unsigned side : {0U, self}) {
      Eigen::Vector3d outward = Eigen::Vector3d::Zero();
      outward[axis] = side != 0 ? 1 : -1;
      quad_facing(mesh,
                  {v[side][axis], v[side | a][axis], v[side | a | b][axis], v[side | b][axis]},
                  outward);
    }
    if (!fine) continue;
    // The four edges along this axis, each between the faces of the two other axes.
    const unsigned face_a = (axis + 1) % 3, face_b = (axis + 2) % 3;
    for (unsigned corner : {0U, a, b, a | b}) {
      Eigen::Vector3d outward = Eigen::Vector3d::Zero();
      outward[face_a] = (corner & a) != 0 ? 1 : -1;
      outward[face_b] = (corner & b) != 0 ? 1 : -1;
      quad_facing(mesh,
                  {v[corner][face_a], v[corner | self][face_a], v[corner | self][face_b],
                   v[corner][face_b]},
                  outward);
    }
  }
  for (unsigned corner = 0; fine && corner < 8; ++corner) {
    // An odd number of negative axes mirrors the order of the three faces.
    const bool mirrored = __builtin_popcount(corner) % 2 == 0;
    mesh.triangle(v[corner][0], v[corner][mirrored ? 2 : 1], v[corner][mirrored ? 1 : 2]);
  }
  return mesh;
}

Mesh plane_mesh(double length_x, double length_y) {
  Mesh mesh;
  const double x = 0.5 * length_x, y = 0.5 * length_y;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  mesh.quad(mesh.add({-x, -y, 0}, up, -x, -y), mesh.add({x, -y, 0}, up, x, -y),
            mesh.add({x, y, 0}, up, x, y), mesh.add({-x, y, 0}, up, -x, y));
  return mesh;
}

}  // namespace kaz::sim
