// Elastic shear of soft contact points, kept from step to step (bristle friction).
// SPDX-License-Identifier: Apache-2.0
//
// A rubber sole yields elastically before it slips. Friction without memory accumulates the errors of all
// steps, so that even a standing robot drifts. In this model, each contact point has a spring and a damper
// along the surface. The softness along the surface is equal to the softness along the normal. The point
// slips if the spring force exceeds mu times the normal force (as in Cundall & Strack, Geotechnique 29(1),
// 1979). The solver has one row for each of the two tangents t:
//
//     t (v_a - v_b) = -erp / h t shear - softness f,   |f| <= mu N
//
// Here `v_a` and `v_b` are the velocities of the bodies `a` and `b`. `f` is the force on body `a` along the
// tangent `t`. The parameters erp and softness have the values for the step size h (contact_surface.h). The
// stiffness of the spring is kContactErp / (kErpStep * softness), in N/m. Surfaces without softness have no
// shear. All vectors are in the world frame, lengths in m.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/body/contact/contacts.h"

namespace kaz::sim {

class ContactMemory {
 public:
  // Call recall() before a step. For each contact point in `touches`, recall() copies the shear of the
  // nearest matching point of the previous step. Points match if they belong to the same pair of shapes and
  // are less than 3 mm apart.
  void recall(std::span<const Touch> touches);
  static bool has_shear(const Touch& touch) { return touch.surface.softness > 0; }
  // Displacement of body a relative to body b in the tangent plane, m, world axes. `touch` is an index into
  // the list passed to recall().
  const Eigen::Vector3d& shear(std::size_t touch) const { return points_[touch].shear; }
  // Call remember() after the step. Integrates the shear and limits the spring force to mu times the normal
  // force. `velocity` is the velocity of body a relative to body b at the contact point, m/s.
  void remember(std::size_t touch, const Eigen::Vector3d& velocity, double normal_n, double step_s);

  template <class A>
  void transfer(A& a) {
    auto size = static_cast<std::uint32_t>(points_.size());
    a(size);
    if (!a.good()) return;
    if (size > kMaxPoints) return a.refuse("it has more contact points than a world can have");
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
    // The maximum shear of the point is limit * kErpStep * normal force. The unit of `limit` is m / (N s).
    double limit = 0;
  };
  std::vector<Point> points_, before_;
};

}  // namespace kaz::sim
