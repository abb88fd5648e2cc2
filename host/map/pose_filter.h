// Estimates the robot's pose from odometry and from repeated views of the same floor pattern.
// SPDX-License-Identifier: Apache-2.0
//
// Extended Kalman filter. The filter's state contains the present pose and copies of past poses. At each of
// these past poses, a view of the floor was taken. Odometry widens the covariance of the present pose. A
// match of two floor views measures the present pose relative to a past pose. The match corrects both poses
// according to their uncertainty. A match is rejected if its relative pose deviates by more than 4 sigma from
// the prediction of the filter. The two views of a rejected match usually show different planks, or different
// squares, that look alike. Source: Roumeliotis and Burdick, "Stochastic cloning: a generalized framework for
// processing relative state measurements", ICRA 2002.
//
// Map frame. Poses are (x, y, heading): m, rad. A relative pose is in the frame of its reference pose, with x
// ahead.
#pragma once

#include <Eigen/Core>

namespace kaz::map {

// pose_between() returns pose `to` relative to pose `from`. pose_after() is the inverse function: it moves
// the pose `from` by `relative`.
Eigen::Vector3d pose_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);
Eigen::Vector3d pose_after(const Eigen::Vector3d& from, const Eigen::Vector3d& relative);

class PoseFilter {
 public:
  PoseFilter() : mean_(Eigen::Vector3d::Zero()), covariance_(Eigen::Matrix3d::Zero()) {}

  // Enters a pose of odometry, in the frame of odometry. The first pose entered becomes the pose on the map.
  // A later pose moves the pose on the map by the change of odometry since the previous call.
  void move(const Eigen::Vector3d& by_odometry);
  // Converts a pose of odometry to a pose on the map.
  Eigen::Vector3d at(const Eigen::Vector3d& by_odometry) const;
  // Remembers the present pose and returns its number. If the robot has not moved since the last call of
  // remember(), returns the number of that call.
  int remember();
  Eigen::Vector3d remembered(int number) const { return mean_.segment<3>(3 + 3 * number); }
  // Returns the covariance of the present pose relative to the remembered pose `number`.
  Eigen::Matrix3d covariance_from(int number) const;
  // Enters a measurement of the present pose relative to the remembered pose `number`. If the measurement
  // deviates by more than 4 sigma from the relative pose that the filter expects, returns false and changes
  // nothing. The limit is the 99.9 % quantile of chi-squared with three degrees of freedom.
  bool measure(int number, const Eigen::Vector3d& relative, const Eigen::Matrix3d& covariance);

  Eigen::Vector3d pose() const { return mean_.head<3>(); }
  Eigen::Matrix3d covariance() const { return covariance_.topLeftCorner<3, 3>(); }

 private:
  // d(pose_between(remembered, present)) / d(mean).
  Eigen::MatrixXd slope(int number) const;
  Eigen::VectorXd mean_;        // present pose, followed by the remembered poses
  Eigen::MatrixXd covariance_;  // covariance of mean_
  Eigen::Vector3d odometry_{0, 0, 0};
  bool started_ = false, moved_ = true;
};

}  // namespace kaz::map
