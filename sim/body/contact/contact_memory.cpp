// Elastic shear of soft contact points, kept from step to step.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact/contact_memory.h"

#include <algorithm>

#include "sim/body/contact/contact_surface.h"

namespace kaz::sim {
namespace {

constexpr double kSamePoint = 0.003;  // m, max displacement of a contact point in a step

}  // namespace

void ContactMemory::recall(std::span<const Touch> touches) {
  std::swap(points_, before_);
  points_.resize(touches.size());
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const Touch& touch = touches[i];
    Point& point = points_[i];
    point.shape_a = touch.shape_a;
    point.shape_b = touch.shape_b;
    point.at = touch.at;
    point.normal = touch.normal;
    point.limit = touch.surface.mu * touch.surface.softness / kContactErp;
    point.shear.setZero();
    // The nearest old point of the same shapes; its shear is projected onto the new tangent plane:
    // s - n (n . s).
    double nearest = kSamePoint * kSamePoint;
    for (const Point& old : before_) {
      if (old.shape_a != touch.shape_a || old.shape_b != touch.shape_b) continue;
      const double distance = (old.at - touch.at).squaredNorm();
      if (distance >= nearest) continue;
      nearest = distance;
      point.shear = old.shear - touch.normal * touch.normal.dot(old.shear);
    }
  }
}

void ContactMemory::remember(std::size_t touch, const Eigen::Vector3d& velocity, double normal_n,
                             double step_s) {
  Point& point = points_[touch];
  // s += h v_t, then |s| <= mu N / k with the spring k = kContactErp / (kErpStep softness), N/m.
  point.shear += step_s * (velocity - point.normal * point.normal.dot(velocity));
  const double max = std::max(0.0, normal_n) * point.limit * kErpStep;
  const double size = point.shear.norm();
  if (size > max) point.shear *= size > 0 ? max / size : 0;
}

}  // namespace kaz::sim
