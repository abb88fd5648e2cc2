// How far soft surfaces are sheared where they touch, from step to step.
// SPDX-License-Identifier: Apache-2.0
//
// A rubber sole that is pushed sideways gives before it slips, and comes back. Friction that forgets
// where it gripped lets every error of a step stand: a robot that only stands then wanders. Here a
// point of contact is a spring with a damper across, of the same softness as along its normal, and
// slips when the spring would pull with more than mu times the normal force. Rows of the solver for
// the two directions t across:
//     t (v_a - v_b) = -erp / h t shear - softness f,   |f| <= mu N
// with f the force on a along t, erp and softness for the step h (contact_surface.h). That is a spring of
// kContactErp / (kErpStep softness) N/m. Surfaces without softness have no shear.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/body/contact/contacts.h"

namespace kaz::sim {

class ContactMemory {
 public:
  // Before a step: what the points of the step before have become. A point is the same if it lies
  // between the same shapes, not further than 3 mm from where it was.
  void recall(std::span<const Touch> touches);
  static bool has_shear(const Touch& touch) { return touch.surface.softness > 0; }
  // Of a against b, across the normal, m; by the number of the touch.
  const Eigen::Vector3d& shear(std::size_t touch) const { return points_[touch].shear; }
  // After the step: velocity of a against b at the point, and the force along the normal.
  void remember(std::size_t touch, const Eigen::Vector3d& velocity, double normal_n, double step_s);

  template <class A>
  void transfer(A& a) {
    auto size = static_cast<std::uint32_t>(points_.size());
    a(size);
    if (!a.good()) return;
    if (size > kMaxPoints) return a.refuse("it has more points of contact than a world can have");
    points_.resize(size);
    for (Point& point : points_) {
      a(point.shape_a, point.shape_b, point.limit);
      for (Eigen::Vector3d* v : {&point.at, &point.shear, &point.normal})
        for (int k = 0; k < 3; ++k) a((*v)[k]);
    }
  }

 private:
  static constexpr std::uint32_t kMaxPoints = 100'000;
  struct Point {
    std::uint32_t shape_a = 0, shape_b = 0;
    Eigen::Vector3d at = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d shear = Eigen::Vector3d::Zero();
    double limit = 0;  // shear at which it slips under 1 N along the normal, m s
  };
  std::vector<Point> points_, before_;
};

}  // namespace kaz::sim
