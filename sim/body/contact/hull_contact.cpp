// Contact points of two convex polyhedra that touch with faces.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact/hull_contact.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {
namespace {

using Eigen::Vector3d;
using Polygon = std::vector<Vector3d>;

constexpr double kParallel = 0.95;  // cosine of the angle between the contact's normal and a face's
// Vertices up to this distance from the plane of a face belong to the face: meshes of plane faces have
// rounded vertices.
constexpr double kSameFace = 2e-4;  // m

struct Face {
  Vector3d normal = Vector3d::UnitZ();  // outward unit vector
  double offset = 0;                    // normal . p of its points, m
};

const Face kNowhere{Vector3d::UnitZ(), -1e300};  // no point is behind it

constexpr double kSameDepth = 1e-4;  // m

std::size_t vertices_of(const Polyhedron& solid) {
  return solid.hull ? solid.hull->size() : 8;
}

Vector3d vertex(const Polyhedron& solid, std::size_t i) {
  const Vector3d local =
      solid.hull
          ? solid.hull->point(i)
          : Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).cwiseProduct(solid.half);
  return solid.at + solid.axes * local;
}

// Depth of the solid's deepest vertex behind the plane of a face, m.
double penetration(const Polyhedron& solid, const Face& face) {
  double deepest = -1e300;
  for (std::size_t i = 0; i < vertices_of(solid); ++i)
    deepest = std::max(deepest, face.offset - face.normal.dot(vertex(solid, i)));
  return deepest;
}

// The face whose normal is most parallel to `along`.
Face face_along(const Polyhedron& solid, const Vector3d& along) {
  const Vector3d local = solid.axes.transpose() * along;
  Face face;
  if (solid.hull == nullptr) {
    Eigen::Index k = 0;
    local.cwiseAbs().maxCoeff(&k);
    face.normal = std::copysign(1.0, local[k]) * solid.axes.col(k);
    face.offset = solid.half[k] + face.normal.dot(solid.at);
    return face;
  }
  const std::vector<double>& planes = solid.hull->planes;
  double best = -2;
  for (std::size_t i = 0; i + 3 < planes.size(); i += 4) {
    const Eigen::Map<const Vector3d> normal(planes.data() + i);
    if (normal.dot(local) <= best) continue;
    best = normal.dot(local);
    face.normal = solid.axes * normal;
    face.offset = planes[i + 3] + face.normal.dot(solid.at);
  }
  return face;
}

// A face that clips: one of `b` or of `a`.
struct Clip {
  bool by_b = true;
  Face face;
};

// The face that the other solid penetrates least.
Clip shallowest(const Polyhedron& a, const Polyhedron& b) {
  Clip best;
  double least = 1e300;
  for (const bool by_b : {true, false}) {
    const Polyhedron &solid = by_b ? b : a, &other = by_b ? a : b;
    const std::size_t faces = solid.hull ? solid.hull->planes.size() / 4 : 6;
    for (std::size_t i = 0; i < faces; ++i) {
      const Vector3d local =
          solid.hull ? Vector3d(Eigen::Map<const Vector3d>(solid.hull->planes.data() + 4 * i))
                     : Vector3d((i < 3 ? 1 : -1) * Vector3d::Unit(static_cast<int>(i % 3)));
      const Face face = face_along(solid, solid.axes * local);
      const double depth = penetration(other, face);
      if (depth >= least) continue;
      least = depth;
      best = {by_b, face};
    }
  }
  return best;
}

// Corners of a face, and all vertices behind the plane `behind`, counterclockwise about the face's normal.
Polygon corners_of(const Polyhedron& solid, const Face& face, const Face& behind) {
  Polygon corners;
  const auto add = [&](const Vector3d& point) {
    if (std::abs(face.normal.dot(point) - face.offset) < kSameFace ||
        behind.normal.dot(point) < behind.offset)
      corners.push_back(point);
  };
  for (std::size_t i = 0; i < vertices_of(solid); ++i) add(vertex(solid, i));
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& corner : corners) middle += corner / static_cast<double>(corners.size());
  const Vector3d u = face.normal.unitOrthogonal(), v = face.normal.cross(u);
  std::ranges::sort(corners, {}, [&](const Vector3d& corner) {
    return std::atan2(v.dot(corner - middle), u.dot(corner - middle));
  });
  return corners;
}

// The part of a convex polygon in front of the plane through `edge` with the normal `inward`.
Polygon clipped(const Polygon& polygon, const Vector3d& edge, const Vector3d& inward) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d &here = polygon[i], &next = polygon[(i + 1) % polygon.size()];
    const double from = inward.dot(here - edge), to = inward.dot(next - edge);
    if (from >= 0) kept.push_back(here);
    if ((from < 0) != (to < 0)) kept.push_back(here + from / (from - to) * (next - here));
  }
  return kept;
}

}  // namespace

bool face_contact(const Polyhedron& a, const Polyhedron& b, double depth, Vector3d& normal,
                  std::vector<DeepPoint>& points) {
  const Face of_a = face_along(a, -normal), of_b = face_along(b, normal);
  const double like_a = -of_a.normal.dot(normal), like_b = of_b.normal.dot(normal);
  // If two faces are parallel, always uses the same one, so that the points do not jump.
  Clip clip{like_b >= like_a - 1e-3, like_b >= like_a - 1e-3 ? of_b : of_a};
  const auto fits = [&](const Clip& one) {
    return penetration(one.by_b ? a : b, one.face) <= depth + kSameDepth;
  };
  // The estimate may be wrong where the solids only just touch.
  if (std::max(like_a, like_b) < kParallel || !fits(clip)) clip = shallowest(a, b);
  if (!fits(clip)) return false;
  const Polyhedron& other = clip.by_b ? a : b;
  const Face& face = clip.face;
  const Polygon sides = corners_of(clip.by_b ? b : a, face, kNowhere);
  Polygon area = corners_of(other, face_along(other, -face.normal), face);
  for (std::size_t i = 0; i < sides.size(); ++i)
    area = clipped(area, sides[i], face.normal.cross(sides[(i + 1) % sides.size()] - sides[i]));
  points.clear();
  for (const Vector3d& point : area) {
    const double deep = face.offset - face.normal.dot(point);
    if (deep >= 0) points.emplace_back(point, deep);
  }
  if (points.empty()) return false;
  normal = clip.by_b ? face.normal : -face.normal;
  return true;
}

std::array<int, 4> spanning_points(std::span<const DeepPoint> points, const Vector3d& normal) {
  const auto farthest = [&](const auto& measure) {
    return static_cast<int>(std::ranges::max_element(points, {}, measure) - points.begin());
  };
  const auto at = [&](int i) { return points[static_cast<std::size_t>(i)].first; };
  const int deepest = farthest([](const DeepPoint& one) { return one.second; });
  const Vector3d first = at(deepest);
  const int second =
      farthest([&](const DeepPoint& one) { return (one.first - first).squaredNorm(); });
  const Vector3d across = normal.cross(at(second) - first);
  const auto side = [&](const DeepPoint& one) { return across.dot(one.first - first); };
  const int left = farthest(side);
  const int right = farthest([&](const DeepPoint& one) { return -side(one); });
  std::array<int, 4> chosen{-1, -1, -1, -1};
  std::size_t count = 0;
  for (const int one : {deepest, second, left, right})
    if (std::ranges::count(chosen, one) == 0) chosen[count++] = one;
  return chosen;
}

}  // namespace kaz::sim
