// Makes triangle meshes for the shapes in a scene. Vertices are in the frame of the visual.
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
  std::array<float, 3> normal;    // unit vector
  // Texture coordinates: distance along the surface, m; Texture::repeat_m is the period.
  std::array<float, 2> uv;
};

// The vertices of a triangle are counter-clockwise as seen from outside.
struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  // three indices per triangle

  std::uint32_t add(const Eigen::Vector3d& position, const Eigen::Vector3d& normal, double u,
                    double v);
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
};

// Coarse meshes are closed and have about a quarter of the triangles of fine meshes. Coarse meshes are used
// for the shadow map, and for pieces that are small in the picture.
enum class Detail { fine, coarse };

// Makes a box with the given side lengths (m). With Detail::fine, the box gets beveled edges, which are
// shaded as if the edges were round. At each edge, the bevel shortens both faces by the smaller of two
// lengths: 2 mm, and 12 % of the box's shortest side.
Mesh box_mesh(const Eigen::Vector3d& lengths, Detail detail = Detail::fine);
Mesh cylinder_mesh(double radius, double length, Detail detail = Detail::fine);
Mesh capsule_mesh(double radius, double length, Detail detail = Detail::fine);
// Makes a subdivided icosahedron. The mesh has the same volume as a sphere with the radius `radius`.
// Therefore the outline of the mesh in a picture has a mean radius of about `radius`.
Mesh sphere_mesh(double radius, Detail detail = Detail::fine);
// Makes a plane with normal +z, centered at the origin.
Mesh plane_mesh(double length_x, double length_y);
// Reads a mesh file (read_mesh() in sim/body/description/mesh_file.h).
Result<Mesh> load_mesh(const std::string& path, const Eigen::Vector3d& scale);

// Makes the mesh of a shape. Returns Fault::usage if a length or radius is not positive, or if a mesh file
// cannot be read. Meshes from files are the same for both values of `detail`.
Result<Mesh> make_mesh(const Shape& shape, Detail detail = Detail::fine);

}  // namespace kaz::sim
