// Intersection of the viewing ray with the floor, and the track in the odometry frame.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/ball_place.h"

#include <algorithm>
#include <cmath>

namespace kaz::behavior {

namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr double kMinDescent = 0.14;  // sine of 8 degrees
// Tolerance of the distance from the apparent size (relative and m): it is accurate to a few percent,
// less far away and at the image border.
constexpr double kSizeTolerance = 0.30, kSizeTolerance_m = 0.03;
// Standard deviation of the ray's direction, rad: potentiometers of five joints in series, play, and the
// compliance of the soles.
constexpr double kRaySigma = 0.008;
constexpr Time kRollsOn = std::chrono::milliseconds(300);

// A ball that rests or rolls: odometry errors act as its motion; pushes are rare.
vision::BallTrackOptions options(double radius) {
  vision::BallTrackOptions options;
  options.radius_m = radius;
  options.acceleration_psd = 0.01;
  options.initial_speed_m_s = 0.2;
  options.lost_after = std::chrono::milliseconds(1500);
  options.floor_m = 0;
  return options;
}

Eigen::Rotation2Dd turned(double heading) {
  return Eigen::Rotation2Dd(heading);
}

}  // namespace

std::optional<FloorPoint> on_floor(const vision::BallObservation& seen, double radius) {
  const vision::FrameInfo& info = seen.info;
  if (!seen.found || !info.posture_known || info.joint_rad.size() != KZ_JOINTS) return std::nullopt;
  host::JointAngles angles;
  std::copy(info.joint_rad.begin(), info.joint_rad.end(), angles.begin());
  const Eigen::Isometry3d sole_from_eye = host::foot_from_eye(angles);
  const Vector3d eye = sole_from_eye.translation(), ray = sole_from_eye.linear() * seen.direction;
  if (-ray.z() < kMinDescent || eye.z() <= radius) return std::nullopt;
  // Foot frame: the point eye + distance ray at the height of the ball's centre.
  const double distance = (eye.z() - radius) / -ray.z();
  if (std::abs(seen.distance_m - distance) > kSizeTolerance * distance + kSizeTolerance_m)
    return std::nullopt;

  const host::Side foot = host::supporting_foot(angles);
  const Vector2d from_sole = (eye + distance * ray).head<2>();
  FloorPoint point;
  const double hip_y = host::kLeg.hip_y;
  point.from_middle = from_sole + Vector2d(0, foot == host::Side::left ? hip_y : -hip_y);
  point.from_hips = from_sole - motion::hips_over_sole(angles, foot).head<2>();
  // The ray's angular error moves the point by distance sigma across the ray and, because the ray meets
  // the floor at a grazing angle, by distance sigma / sin(descent) along it.
  const double level = ray.head<2>().norm();
  if (level > 1e-6) point.along = ray.head<2>() / level;
  point.sigma_across = std::hypot(0.002, distance * kRaySigma);
  point.sigma_along = point.sigma_across / -ray.z();
  return point;
}

host::Gaze gaze_at_floor(const host::JointAngles& angles, const Vector3d& from_middle) {
  const host::Side foot = host::supporting_foot(angles);
  const double hip_y = foot == host::Side::left ? host::kLeg.hip_y : -host::kLeg.hip_y;
  return host::gaze_at(host::trunk_from_sole(angles, foot) * (from_middle - Vector3d(0, hip_y, 0)));
}

BallPlace::BallPlace(double radius) : radius_(radius), track_(options(radius)) {}

bool BallPlace::observe(const vision::BallObservation& seen, const PlaceHistory& places) {
  const auto point = on_floor(seen, radius_);
  const auto robot = places.at(seen.info.exposure);
  if (!point || !robot) return false;
  const Eigen::Matrix2d axes = turned(robot->heading).toRotationMatrix();
  const Vector2d at = Vector2d(robot->x, robot->y) + axes * point->from_hips;
  const Vector2d along = axes * point->along, across(-along.y(), along.x());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance.topLeftCorner<2, 2>() =
      point->sigma_along * point->sigma_along * along * along.transpose() +
      point->sigma_across * point->sigma_across * across * across.transpose();
  covariance(2, 2) = 1e-6;
  const auto taken =
      track_.observe(seen.info.exposure, Vector3d(at.x(), at.y(), radius_), covariance);
  return taken != vision::BallTrack::Taken::outlier && taken != vision::BallTrack::Taken::refused;
}

Vector2d BallPlace::at(Time t) const {
  return track_.aim(std::min(t, last_seen() + kRollsOn)).head<2>();
}

Vector2d BallPlace::from_hips(Time t, const motion::Place& robot) const {
  return turned(-robot.heading) * (at(t) - Vector2d(robot.x, robot.y));
}

double BallPlace::speed() const {
  return known() ? track_.at(last_seen()).velocity.head<2>().norm() : 0;
}

}  // namespace kaz::behavior
