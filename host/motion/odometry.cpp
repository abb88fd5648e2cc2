// Sums up what the hips move against the carrying soles.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/odometry.h"

#include <cmath>

namespace kaz::motion {

namespace {

constexpr double kSlip = 0.015;      // share of the path length, one sigma
constexpr double kStanding = 0.001;  // m, one sigma of a standing robot: sagging and gear play

}  // namespace

Eigen::Vector3d hips_over_sole(const JointAngles& measured, Side side) {
  return host::trunk_from_sole(measured, side).inverse().translation();
}

void Odometry::add(const JointAngles& measured, double left_share, double heading,
                   double sigma_heading) {
  const std::array<Eigen::Vector2d, 2> now{hips_over_sole(measured, Side::left).head<2>(),
                                           hips_over_sole(measured, Side::right).head<2>()};
  if (started_) {
    const Eigen::Vector2d moved =
        left_share * (now[0] - hips_[0]) + (1 - left_share) * (now[1] - hips_[1]);
    const double middle = (place_.heading + heading) / 2;
    place_.x += std::cos(middle) * moved.x() - std::sin(middle) * moved.y();
    place_.y += std::sin(middle) * moved.x() + std::cos(middle) * moved.y();
    walked_ += moved.x();
    way_ += std::abs(moved.x());
  }
  started_ = true;
  hips_ = now;
  place_.heading = heading;
  place_.sigma_heading = sigma_heading;
  place_.sigma_along = std::hypot(kStanding, kSlip * way_);
  // A heading error that grows linearly along the path displaces the end by half of it times the path
  // length.
  place_.sigma_across = std::hypot(kStanding, kSlip * way_, sigma_heading / 2 * way_);
}

}  // namespace kaz::motion
