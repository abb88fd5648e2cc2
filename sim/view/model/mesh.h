// Makes triangle meshes of the shapes in a scene, in the frame of their visual.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"

namespace kaz::sim {

struct Vertex {
  std::array<float, 3> position;  // m
  std::array<float, 3> normal;    // unit
  std::array<float, 2> uv;        // m along the surface; the texture defines the period
};

// Triangles are counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  // three per triangle

  std::uint32_t add(const Eigen::Vector3d& position, const Eigen::Vector3d& normal, double u,
                    double v);
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
};

// Coarse meshes are closed and have about a quarter of the triangles. They serve the shadow map and pieces
// that are small in the picture.
enum class Detail { fine, coarse };

// Sizes in m. A fine box has edges beveled by min(2 mm, 12 % of the shortest side), shaded as if round.
Mesh box_mesh(const Eigen::Vector3d& lengths, Detail detail = Detail::fine);
Mesh cylinder_mesh(double radius, double length, Detail detail = Detail::fine);
Mesh capsule_mesh(double radius, double length, Detail detail = Detail::fine);
// Subdivided icosahedron with the sphere's volume, so that its mean outline has the sphere's size.
Mesh sphere_mesh(double radius, Detail detail = Detail::fine);
// Normal +z, center at the origin.
Mesh plane_mesh(double length_x, double length_y);
// Reads OBJ (v, vn, f with any polygon) or STL (text or binary), selected by the path's extension. Returns
// Fault::usage if the file is missing or invalid.
Result<Mesh> load_mesh(const std::string& path, const Eigen::Vector3d& scale);

// Returns Fault::usage if a size is not positive or a mesh file cannot be read. Meshes from files have one
// level of detail.
Result<Mesh> make_mesh(const Shape& shape, Detail detail = Detail::fine);

}  // namespace kaz::sim
