// Where the robot is, by odometry and by views of the floor that show the same pattern.
// SPDX-License-Identifier: Apache-2.0
//
// Extended Kalman filter over the present pose and copies of past ones, from which the floor was seen:
// odometry widens the present pose; a match says where it is as seen from a past one, and corrects both by
// what each is uncertain (S. I. Roumeliotis, J. W. Burdick, "Stochastic cloning: a generalized framework for
// processing relative state measurements", ICRA 2002). A match that lies too far off for both
// uncertainties is refused: another plank, another square.
//
// Frame: the map's. Poses are (x, y, heading): m, rad. Relative poses are seen from the first, its x ahead.
#pragma once

#include <Eigen/Core>

namespace kaz::map {

// `to` seen from `from`, and back: `from` moved by `relative`.
Eigen::Vector3d pose_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);
Eigen::Vector3d pose_after(const Eigen::Vector3d& from, const Eigen::Vector3d& relative);

class PoseFilter {
 public:
  PoseFilter() : mean_(Eigen::Vector3d::Zero()), covariance_(Eigen::Matrix3d::Zero()) {}

  // Odometry's pose, in its own frame. The first is taken as it is; afterwards what it moved since counts.
  void move(const Eigen::Vector3d& by_odometry);
  // Where odometry's pose `by_odometry` is on the map.
  Eigen::Vector3d at(const Eigen::Vector3d& by_odometry) const;
  // Remembers the present pose; its number. Where the robot has not moved since the last, the same.
  int remember();
  Eigen::Vector3d remembered(int number) const { return mean_.segment<3>(3 + 3 * number); }
  // Of the present pose as seen from a remembered one.
  Eigen::Matrix3d covariance_from(int number) const;
  // The present pose as seen from a remembered one. False, and nothing is changed: it is farther off than
  // 4 sigma (chi-squared of three, 99.9 %).
  bool measure(int number, const Eigen::Vector3d& relative, const Eigen::Matrix3d& covariance);

  Eigen::Vector3d pose() const { return mean_.head<3>(); }
  Eigen::Matrix3d covariance() const { return covariance_.topLeftCorner<3, 3>(); }

 private:
  // d(pose_between(remembered, present)) / d(mean).
  Eigen::MatrixXd slope(int number) const;
  Eigen::VectorXd mean_;        // the present pose, then those remembered
  Eigen::MatrixXd covariance_;  // of all
  Eigen::Vector3d odometry_{0, 0, 0};
  bool started_ = false, moved_ = true;
};

}  // namespace kaz::map
