// Cylinders, capsules and spheres.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "sim/render/model/mesh.h"

namespace kaz::sim {

namespace {

constexpr double kPi = 3.14159265358979323846;

// A point of the profile of a solid of revolution about z, with its normal.
struct ProfilePoint {
  double radius, z;
  double normal_radius, normal_z;
};

// Profile from the top (+z) to the bottom.
Mesh turned(const std::vector<ProfilePoint>& profile, int segments) {
  Mesh mesh;
  double along = 0;
  for (std::size_t ring = 0; ring < profile.size(); ++ring) {
    const ProfilePoint& p = profile[ring];
    if (ring > 0)
      along += std::hypot(p.radius - profile[ring - 1].radius, p.z - profile[ring - 1].z);
    for (int s = 0; s <= segments; ++s) {  // the seam has two vertices: its uv differ
      const double angle = 2 * kPi * s / segments, c = std::cos(angle), d = std::sin(angle);
      mesh.add({p.radius * c, p.radius * d, p.z},
               {p.normal_radius * c, p.normal_radius * d, p.normal_z}, angle * p.radius, along);
    }
  }
  const auto index = [&](std::size_t ring, int s) {
    return static_cast<std::uint32_t>(ring * static_cast<std::size_t>(segments + 1) +
                                      static_cast<std::size_t>(s));
  };
  for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring) {
    const bool from_axis = profile[ring].radius == 0, to_axis = profile[ring + 1].radius == 0;
    for (int s = 0; s < segments; ++s) {
      const std::uint32_t a = index(ring, s), b = index(ring + 1, s), c = index(ring + 1, s + 1),
                          d = index(ring, s + 1);
      if (!to_axis) mesh.triangle(a, b, c);
      if (!from_axis) mesh.triangle(a, c, d);
    }
  }
  return mesh;
}

// Small parts need fewer segments, as they are never large in a picture.
int segments_for(double radius, Detail detail) {
  return detail == Detail::fine ? std::clamp(static_cast<int>(14 + radius * 600), 16, 40) : 12;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Triangle = std::array<std::uint32_t, 3>;

struct Icosphere {
  std::vector<Eigen::Vector3d> points;  // unit
  std::vector<Triangle> triangles;
};

Icosphere icosahedron() {
  const double t = 0.5 * (1 + std::sqrt(5.0));  // golden ratio
  Icosphere ico;
  for (const auto& p :
       {Eigen::Vector3d(-1, t, 0), Eigen::Vector3d(1, t, 0), Eigen::Vector3d(-1, -t, 0),
        Eigen::Vector3d(1, -t, 0), Eigen::Vector3d(0, -1, t), Eigen::Vector3d(0, 1, t),
        Eigen::Vector3d(0, -1, -t), Eigen::Vector3d(0, 1, -t), Eigen::Vector3d(t, 0, -1),
        Eigen::Vector3d(t, 0, 1), Eigen::Vector3d(-t, 0, -1), Eigen::Vector3d(-t, 0, 1)}) {
    ico.points.push_back(p.normalized());
  }
  ico.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                   {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                   {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                   {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return ico;
}

void subdivide(Icosphere& ico) {
  std::map<Edge, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                    static_cast<std::uint32_t>(ico.points.size()));
    if (fresh) ico.points.push_back((ico.points[a] + ico.points[b]).normalized());
    return found->second;
  };
  std::vector<Triangle> finer;
  finer.reserve(4 * ico.triangles.size());
  for (const auto& [a, b, c] : ico.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  ico.triangles = std::move(finer);
}

double volume(const Icosphere& ico) {
  double sum = 0;
  for (const auto& [a, b, c] : ico.triangles) {
    sum += ico.points[a].dot(ico.points[b].cross(ico.points[c])) / 6;
  }
  return sum;
}

}  // namespace

Mesh cylinder_mesh(double radius, double length, Detail detail) {
  const int segments = segments_for(radius, detail);
  if (detail == Detail::coarse) {
    return turned({{0, 0.5 * length, 0, 1},
                   {radius, 0.5 * length, 0, 1},
                   {radius, -0.5 * length, 0, -1},
                   {0, -0.5 * length, 0, -1}},
                  segments);
  }
  const double bevel = std::min({0.0015, 0.12 * radius, 0.12 * length}), half = 0.5 * length;
  return turned({{0, half, 0, 1},
                 {radius - bevel, half, 0, 1},
                 {radius, half - bevel, 1, 0},
                 {radius, -half + bevel, 1, 0},
                 {radius - bevel, -half, 0, -1},
                 {0, -half, 0, -1}},
                segments);
}

Mesh capsule_mesh(double radius, double length, Detail detail) {
  const int rings = detail == Detail::fine ? 6 : 3;  // a hemisphere
  std::vector<ProfilePoint> profile;
  for (int half = 1; half >= -1; half -= 2) {
    for (int ring = 0; ring <= rings; ++ring) {
      const int step = half > 0 ? ring : rings + ring;
      const double angle = 0.5 * kPi * step / rings;
      const bool pole = step == 0 || step == 2 * rings;
      const double sine = pole ? 0.0 : std::sin(angle), cosine = std::cos(angle);
      profile.push_back({radius * sine, half * 0.5 * length + radius * cosine, sine, cosine});
    }
  }
  return turned(profile, segments_for(radius, detail));
}

Mesh sphere_mesh(double radius, Detail detail) {
  Icosphere ico = icosahedron();
  const int levels = detail == Detail::coarse || radius < 0.008 ? 2 : 3;
  for (int i = 0; i < levels; ++i) subdivide(ico);
  const double scale = radius * std::cbrt(4.0 / 3.0 * kPi / volume(ico));
  Mesh mesh;
  for (const Eigen::Vector3d& p : ico.points) {
    mesh.add(scale * p, p, radius * std::atan2(p.y(), p.x()), radius * std::asin(p.z()));
  }
  for (const auto& [a, b, c] : ico.triangles) mesh.triangle(a, b, c);
  return mesh;
}

}  // namespace kaz::sim
