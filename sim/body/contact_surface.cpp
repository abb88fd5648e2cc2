// What two surfaces do to each other where they touch.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact_surface.h"

#include <algorithm>

namespace kaz::sim {
namespace {

constexpr double kErp = 0.2;
constexpr double kMotionToAlign = 1e-4;  // m/s

}  // namespace

dContact contact_of(const Surface& a, const Surface& b, const Eigen::Vector3d& motion,
                    const Eigen::Vector3d& normal, double least_softness) {
  dContact contact{};
  contact.surface.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM;
  contact.surface.mu = std::min(a.mu, b.mu);
  contact.surface.soft_erp = kErp;
  contact.surface.soft_cfm = std::max(a.softness + b.softness, least_softness);
  const Surface& livelier = a.restitution >= b.restitution ? a : b;
  if (livelier.restitution > 0) {
    contact.surface.mode |= dContactBounce;
    contact.surface.bounce = livelier.restitution;
    contact.surface.bounce_vel = livelier.bounce_threshold;
  }
  const double rolling = std::max(a.rolling_resistance, b.rolling_resistance);
  if (rolling <= 0) return contact;
  contact.surface.mode |= dContactRolling;
  contact.surface.rho = rolling;
  contact.surface.rho2 = rolling;
  contact.surface.rhoN = rolling;
  // ODE bounds each axis of the contact by itself: along the motion, or the path would bend.
  if (motion.norm() > kMotionToAlign) {
    contact.surface.mode |= dContactFDir1;
    Eigen::Vector3d along = motion - normal * normal.dot(motion);
    if (along.norm() < kMotionToAlign) along = normal.unitOrthogonal();
    along.normalize();
    for (int k = 0; k < 3; ++k) contact.fdir1[k] = along[k];
  }
  return contact;
}

}  // namespace kaz::sim
