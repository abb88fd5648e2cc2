// True edges of the floor, and the errors of a map's edges.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/figure7/yard.h"

#include <algorithm>
#include <cmath>

#include "tools/trials/statistics.h"

namespace kaz::figure7 {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStep_m = 0.005, kBefore_m = 0.06;

// Corners of the lower rim of a box in order; outward is to the right of each side.
std::vector<Vector3d> rim(const Box& box) {
  const Vector3d h = 0.5 * box.size;
  std::vector<Vector3d> corners;
  for (const auto& [x, y] : {std::pair{-1, -1}, {-1, 1}, {1, 1}, {1, -1}})
    corners.push_back(box.pose * Vector3d(x * h.x(), y * h.y(), -h.z()));
  return corners;
}

// Whether a box is on the line from `from` to `to`, without its last millimetre.
bool hidden(const Box& box, const Vector3d& from, const Vector3d& to) {
  const Vector3d start = box.pose.inverse() * from;
  const Vector3d ray = box.pose.inverse() * to - start;
  const Eigen::Array3d one = (-0.5 * box.size - start).array() / ray.array();
  const Eigen::Array3d two = (0.5 * box.size - start).array() / ray.array();
  const double enter = one.min(two).maxCoeff(), leave = one.max(two).minCoeff();
  return enter < leave && leave > 0 && enter < 1 - 0.001 / ray.norm();
}

}  // namespace

std::vector<Box> boxes_of(const sim::Scene& scene) {
  std::vector<Box> boxes;
  for (const sim::Visual& visual : scene.visuals) {
    if (visual.frame == 0 && visual.shape.kind == sim::Shape::Kind::box)
      boxes.push_back({visual.in_frame, visual.shape.size});
  }
  return boxes;
}

std::vector<EdgePoint> edge_points(const std::vector<Box>& boxes,
                                   const Isometry3d& foot_from_world) {
  std::vector<EdgePoint> points;
  for (const Box& box : boxes) {
    const std::vector<Vector3d> corners = rim(box);
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector2d a = (foot_from_world * corners[k]).head<2>();
      const Vector2d b = (foot_from_world * corners[(k + 1) % 4]).head<2>();
      const double length = (b - a).norm();
      const Vector2d along = (b - a) / length, outward(-along.y(), along.x());
      for (double s = kStep_m; s < length - 0.5 * kStep_m; s += kStep_m)
        points.push_back({a + s * along, outward, 0});
    }
  }
  return points;
}

void look(const vision::CameraModel& camera, const Isometry3d& from_eye,
          const std::vector<Box>& boxes, std::vector<EdgePoint>& points) {
  constexpr double kMargin_px = 10;
  const Vector3d left = from_eye.translation();
  const Vector3d right = from_eye * Vector3d(camera.baseline_m, 0, 0);
  const Isometry3d eye_from = from_eye.inverse();
  for (EdgePoint& point : points) {
    const Vector3d place(point.place.x(), point.place.y(), 0), p = eye_from * place;
    if (p.z() < 0.05) continue;
    const Vector2d px = camera.pixel(p);
    const double u = px.x(), v = px.y();
    const double d = camera.fx * camera.baseline_m / p.z();
    if (u - d < kMargin_px || v < kMargin_px || u > camera.width - kMargin_px ||
        v > camera.height - kMargin_px)
      continue;
    bool free = true;
    for (const Box& box : boxes)
      free = free && !hidden(box, left, place) && !hidden(box, right, place);
    point.seen += free ? 1 : 0;
  }
}

std::vector<EdgeError> edge_errors(const map::LocalMap& map, const std::vector<EdgePoint>& points,
                                   double near_m, double far_m) {
  std::vector<EdgeError> errors;
  for (const EdgePoint& point : points) {
    const double distance = point.place.norm();
    if (distance < near_m || distance > far_m || point.seen < kSeenOften) continue;
    double before = kBefore_m;
    for (; before > -kBefore_m; before -= 0.001) {
      const Vector2d at = point.place + before * point.outward;
      if (map.at(at.x(), at.y()).state != map::CellState::floor) break;
    }
    errors.push_back({point, before});
  }
  return errors;
}

EdgeScore score(const std::vector<EdgeError>& errors) {
  if (errors.empty()) return {};
  EdgeScore score{static_cast<int>(errors.size())};
  std::vector<double> sizes;
  for (const EdgeError& e : errors) {
    score.mean_m += e.error_m / static_cast<double>(errors.size());
    sizes.push_back(std::abs(e.error_m));
  }
  score.median_m = trials::quantile(sizes, 0.5);
  score.p95_m = trials::quantile(sizes, 0.95);
  score.max_m = trials::quantile(sizes, 1);
  return score;
}

}  // namespace kaz::figure7
