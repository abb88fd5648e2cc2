// Prediction by odometry, copies of poses, update by a relative pose.
// SPDX-License-Identifier: Apache-2.0
#include "host/map/pose_filter.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "shared/base/angle.hpp"

namespace kaz::map {
namespace {

using Eigen::Matrix2d, Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Vector2d, Eigen::Vector3d;

// Variances of odometry, from walks and turns against truth (decision 102): for each metre
// walked and each radian turned.
constexpr double kPlacePer_m = 0.010 * 0.010, kPlacePer_rad = 0.005 * 0.005;
constexpr double kHeadingPer_m = (1.5 * kDegree) * (1.5 * kDegree);
constexpr double kHeadingPer_rad = (1.0 * kDegree) * (1.0 * kDegree);
// Less is a standing robot's sagging and noise, which does not add up.
constexpr double kStill_m = 0.003, kStill_rad = 0.5 * kDegree;
constexpr double kGate = 16.27;  // chi-squared, 3 degrees of freedom, 99.9 %

double wrapped(double angle) {
  return std::remainder(angle, 2 * std::numbers::pi);
}

}  // namespace

Vector3d pose_between(const Vector3d& from, const Vector3d& to) {
  const Vector2d there = Eigen::Rotation2Dd(-from.z()) * (to - from).head<2>();
  return {there.x(), there.y(), wrapped(to.z() - from.z())};
}

Vector3d pose_after(const Vector3d& from, const Vector3d& relative) {
  const Vector2d at = from.head<2>() + Eigen::Rotation2Dd(from.z()) * relative.head<2>();
  return {at.x(), at.y(), from.z() + relative.z()};
}

void PoseFilter::move(const Vector3d& by_odometry) {
  if (!started_) {
    started_ = true;
    odometry_ = by_odometry;
    mean_.head<3>() = by_odometry;
    return;
  }
  const Vector3d step = pose_between(odometry_, by_odometry);
  const double way = step.head<2>().norm(), turn = std::abs(step.z());
  if (way < kStill_m && turn < kStill_rad) return;
  moved_ = true;
  odometry_ = by_odometry;
  const Vector3d from = pose();
  mean_.head<3>() = pose_after(from, step);
  // With F = d(pose_after)/d(from): P' = F P F^T + Q.
  Matrix3d f = Matrix3d::Identity();
  f(0, 2) = -(mean_.y() - from.y());
  f(1, 2) = mean_.x() - from.x();
  const Eigen::Index others = mean_.size() - 3;
  const Matrix3d own = f * covariance() * f.transpose();
  covariance_.topLeftCorner<3, 3>() = own;
  covariance_.topRightCorner(3, others) = f * covariance_.topRightCorner(3, others).eval();
  covariance_.bottomLeftCorner(others, 3) = covariance_.topRightCorner(3, others).transpose();
  covariance_(0, 0) += kPlacePer_m * way + kPlacePer_rad * turn;
  covariance_(1, 1) += kPlacePer_m * way + kPlacePer_rad * turn;
  covariance_(2, 2) += kHeadingPer_m * way + kHeadingPer_rad * turn;
}

Vector3d PoseFilter::at(const Vector3d& by_odometry) const {
  return started_ ? pose_after(pose(), pose_between(odometry_, by_odometry)) : by_odometry;
}

int PoseFilter::remember() {
  const Eigen::Index n = mean_.size();
  if (moved_ || n == 3) {
    moved_ = false;
    mean_.conservativeResize(n + 3);
    mean_.tail<3>() = pose();
    covariance_.conservativeResize(n + 3, n + 3);
    covariance_.bottomLeftCorner(3, n) = covariance_.topLeftCorner(3, n);
    covariance_.topRightCorner(n, 3) = covariance_.topLeftCorner(n, 3);
    covariance_.bottomRightCorner<3, 3>() = covariance_.topLeftCorner<3, 3>();
  }
  return static_cast<int>(mean_.size()) / 3 - 2;
}

// R^T to the present place, (h_y, -h_x) to the past heading.
MatrixXd PoseFilter::slope(int number) const {
  const Eigen::Index past = 3 + 3 * number;
  const Vector3d before = remembered(number), seen = pose_between(before, pose());
  const Matrix2d back = Eigen::Rotation2Dd(-before.z()).toRotationMatrix();
  MatrixXd h = MatrixXd::Zero(3, mean_.size());
  h.block<2, 2>(0, 0) = back;
  h(2, 2) = 1;
  h.block<2, 2>(0, past) = -back;
  h(0, past + 2) = seen.y();
  h(1, past + 2) = -seen.x();
  h(2, past + 2) = -1;
  return h;
}

Matrix3d PoseFilter::covariance_from(int number) const {
  const MatrixXd h = slope(number);
  return h * covariance_ * h.transpose();
}

bool PoseFilter::measure(int number, const Vector3d& relative, const Matrix3d& noise) {
  Vector3d error = relative - pose_between(remembered(number), pose());
  error.z() = wrapped(error.z());
  const MatrixXd h = slope(number);
  const MatrixXd to = covariance_ * h.transpose();
  const Matrix3d inverse = (h * to + noise).inverse();
  if (error.dot(inverse * error) > kGate) return false;
  const MatrixXd gain = to * inverse;
  mean_ += gain * error;
  covariance_ -= gain * to.transpose();
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  return true;
}

}  // namespace kaz::map
