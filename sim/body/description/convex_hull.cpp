// Convex hulls, enclosing boxes and capsules.
// SPDX-License-Identifier: Apache-2.0
//
// Barber, Dobkin, Huhdanpaa: The Quickhull algorithm for convex hulls, ACM TOMS 22 (1996).
#include "sim/body/description/convex_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <Eigen/Eigenvalues>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace kaz::sim {
namespace {

using Points = std::span<const Eigen::Vector3d>;

constexpr std::size_t kMaxVertices = 200;
constexpr int kDirections = 642;
constexpr double kThinnest = 1e-3;  // m

// One run of Qhull. Its messages go nowhere: the exit code says enough.
class Qhull {
 public:
  explicit Qhull(Points points) {
    qh_zero(&qh_, nullptr);
    for (const Eigen::Vector3d& p : points)
      coordinates_.insert(coordinates_.end(), p.begin(), p.end());
    std::string options = "qhull Qt Pp";
    FILE* const silent = std::fopen("/dev/null", "w");
    status_ = qh_new_qhull(&qh_, 3, static_cast<int>(points.size()), coordinates_.data(), False,
                           options.data(), nullptr, silent);
    if (silent != nullptr) std::fclose(silent);
  }
  ~Qhull() {
    int blocks = 0, bytes = 0;
    qh_freeqhull(&qh_, !qh_ALL);
    qh_memfreeshort(&qh_, &blocks, &bytes);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  bool succeeded() const { return status_ == 0; }

  ConvexHull hull() {
    ConvexHull hull;
    std::vector<int> number(coordinates_.size() / 3, -1);
    qhT* const qh = &qh_;  // Qhull's macros use this name
    facetT* facet = nullptr;
    FORALLfacets {
      setT* const vertices = qh_facet3vertex(qh, facet);
      hull.polygons.push_back(3);
      vertexT *vertex = nullptr, **vertexp = nullptr;
      FOREACHvertex_(vertices) {
        const auto id = static_cast<std::size_t>(qh_pointid(qh, vertex->point));
        if (number[id] < 0) {
          number[id] = static_cast<int>(hull.size());
          hull.points.insert(hull.points.end(), vertex->point, vertex->point + 3);
        }
        hull.polygons.push_back(static_cast<unsigned>(number[id]));
      }
      qh_settempfree(qh, const_cast<setT**>(&vertices));
      hull.planes.insert(hull.planes.end(), facet->normal, facet->normal + 3);
      hull.planes.push_back(-facet->offset);
    }
    return hull;
  }

 private:
  qhT qh_{};
  std::vector<double> coordinates_;
  int status_ = 0;
};

// Evenly distributed unit vectors: a Fibonacci lattice on the sphere.
Eigen::Vector3d direction(int i) {
  const double z = 1 - (2.0 * i + 1) / kDirections, around = std::sqrt(1 - z * z);
  const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
  return {around * std::cos(angle), around * std::sin(angle), z};
}

std::vector<Eigen::Vector3d> extreme(const ConvexHull& hull) {
  std::vector<bool> chosen(hull.size(), false);
  for (int i = 0; i < kDirections; ++i) {
    const Eigen::Vector3d along = direction(i);
    std::size_t best = 0;
    double farthest = hull.point(0).dot(along);
    for (std::size_t k = 1; k < hull.size(); ++k) {
      const double distance = hull.point(k).dot(along);
      if (distance > farthest) {
        best = k;
        farthest = distance;
      }
    }
    chosen[best] = true;
  }
  std::vector<Eigen::Vector3d> points;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    if (chosen[k]) points.push_back(hull.point(k));
  }
  return points;
}

EnclosingBox box_along(Points points, const Eigen::Matrix3d& axes) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend((axes.transpose() * p).eval());
  EnclosingBox out;
  out.at.linear() = axes;
  out.at.translation() = axes * box.center();
  out.lengths = box.sizes().cwiseMax(kThinnest);
  return out;
}

// Right-handed principal axes.
Eigen::Matrix3d principal_axes(Points points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

}  // namespace

std::shared_ptr<const ConvexHull> convex_hull(Points points) {
  if (points.size() < 4) return nullptr;
  Qhull all(points);
  if (!all.succeeded()) return nullptr;
  ConvexHull hull = all.hull();
  if (hull.size() > kMaxVertices) {
    Qhull few(extreme(hull));
    if (few.succeeded()) hull = few.hull();
  }
  return std::make_shared<const ConvexHull>(std::move(hull));
}

EnclosingBox enclosing_box(Points points) {
  const EnclosingBox aligned = box_along(points, Eigen::Matrix3d::Identity());
  const EnclosingBox turned = box_along(points, principal_axes(points));
  return turned.lengths.prod() < aligned.lengths.prod() ? turned : aligned;
}

EnclosingCapsule enclosing_capsule(Points points) {
  const EnclosingBox box = enclosing_box(points);
  Eigen::Index longest = 0;
  box.lengths.maxCoeff(&longest);
  const Eigen::Matrix3d& axes = box.at.linear();
  EnclosingCapsule out;
  out.at = box.at;
  out.at.linear() << axes.col((longest + 1) % 3), axes.col((longest + 2) % 3), axes.col(longest);
  const Eigen::Isometry3d in_capsule = out.at.inverse();
  for (const Eigen::Vector3d& p : points)
    out.radius = std::max(out.radius, (in_capsule * p).head<2>().norm());
  out.radius = std::max(out.radius, kThinnest / 2);
  double half = kThinnest / 2;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d q = in_capsule * p;
    const double cap =
        std::sqrt(std::max(0.0, out.radius * out.radius - q.head<2>().squaredNorm()));
    half = std::max(half, std::abs(q.z()) - cap);
  }
  out.length = 2 * half;
  return out;
}

}  // namespace kaz::sim
