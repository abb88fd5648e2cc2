// Measures the motion of robot and ball by ground truth.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/judge_tracks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/base/angle.hpp"
#include "sim/body/description/world_model.h"

namespace kaz::tools {
namespace {

constexpr double kUpright = 30 * kDegree;  // of the trunk; in the crouch it leans less
constexpr double kLies = 60 * kDegree;
// Height of the trunk's origin, m: 0.16 standing straight, 0.14 in the crouch, 0.07 at most sitting or lying.
constexpr double kHigh_m = 0.11;
constexpr double kTracked = 3 * kDegree;

double yaw_of(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d ahead = pose.linear().col(0);
  return std::atan2(ahead.y(), ahead.x());
}

double height_of(const std::optional<Eigen::Isometry3d>& pose) {
  return pose ? pose->translation().z() : 0;
}

// Sets `begin` to the time since which a condition is true; nullopt: it is false now.
void set_since(std::optional<Time>& begin, bool holds, Time now) {
  if (!holds) begin.reset();
  if (holds && !begin) begin = now;
}

}  // namespace

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

void BodyTrack::look(const Truth& truth) {
  trunk_ = truth.trunk;
  if (!start_) {
    start_ = truth.trunk;
    last_yaw_ = yaw_of(truth.trunk);
    left_foot_m_ = height_of(truth.left_foot);
    right_foot_m_ = height_of(truth.right_foot);
  }
  if (!first_step_ && (height_of(truth.left_foot) > left_foot_m_ + sim::kFirstStep ||
                       height_of(truth.right_foot) > right_foot_m_ + sim::kFirstStep))
    first_step_ = truth.time;
  heading_ += std::remainder(yaw_of(truth.trunk) - last_yaw_, 2 * std::numbers::pi);
  last_yaw_ = yaw_of(truth.trunk);
  if (lies()) has_lain_ = true;
  set_since(upright_since_, upright() && truth.trunk.translation().z() > kHigh_m, truth.time);
}

bool BodyTrack::upright() const {
  return trunk_.linear()(2, 2) > std::cos(kUpright);
}

bool BodyTrack::lies() const {
  return trunk_.linear()(2, 2) < std::cos(kLies);
}

double BodyTrack::forward_m() const {
  return start_ ? (start_->inverse() * trunk_.translation()).x() : 0;
}

double BodyTrack::aside_m() const {
  return start_ ? (start_->inverse() * trunk_.translation()).y() : 0;
}

void BallTrack::look(const Truth& truth) {
  set_since(held_since_, truth.ball && truth.ball->z() >= radius_m_ + kClearOfFloor_m, truth.time);
  if (truth.ball && truth.left_eye) {
    const Eigen::Vector3d seen = truth.left_eye->inverse() * *truth.ball;
    gazes_.push_back({truth.time, angle_between(seen, Eigen::Vector3d::UnitZ()) <= kTracked});
  }
}

double BallTrack::tracked(Time end, double seconds_before) const {
  if (gazes_.empty() || seconds_before <= 0) return 0;
  const Time begin = end - from_seconds(seconds_before);
  Time near{};
  for (std::size_t i = 0; i < gazes_.size(); ++i) {
    const Time until = i + 1 < gazes_.size() ? gazes_[i + 1].time : end;
    if (gazes_[i].near && until > begin) near += until - std::max(gazes_[i].time, begin);
  }
  return seconds(near) / seconds_before;
}

}  // namespace kaz::tools
