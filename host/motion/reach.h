// Trajectory for picking up a ball from the floor with one hand: joint angles over time.
// SPDX-License-Identifier: Apache-2.0
//
// Sequence: bend with the arm forward and the hand open, swing the arm down onto the ball, close, lift,
// stand up. At each time, the hips are placed so that the center of mass is over the planned point of the
// soles (static balance). Units: m, s, rad. Frame: origin on the floor below the midpoint of the ankles, x
// ahead, y left, z up.
#pragma once

#include <optional>
#include <vector>

#include "host/motion/gait.h"

namespace kaz::motion {

class Pickup {
 public:
  // `ball`: position of its center on the floor. Returns nothing if it is out of reach.
  static std::optional<Pickup> plan(Side hand, const Eigen::Vector2d& ball, double radius);
  // Returns this plan with the arm aimed at a new position of the ball; nothing if it is out of reach.
  std::optional<Pickup> aimed_at(const Eigen::Vector2d& ball) const;

  // End time of each part: bent with the arm forward; arm down; hand closed; arm up; standing.
  double bent_s() const { return keys_[kBent].time; }
  double down_s() const { return keys_[kDown].time; }
  double closed_s() const { return keys_[kClosed].time; }
  double lifted_s() const { return keys_[kLifted].time; }
  double end_s() const { return keys_.back().time; }

  Side hand() const { return hand_; }
  int hand_joint() const { return hand_ == Side::left ? host::l_hand : host::r_hand; }
  // closed(): target of the closing hand. stopped(): the largest closing angle at which a ball of this radius
  // stops the hand. Both in rad.
  double closed() const { return closed_; }
  double stopped() const { return stopped_; }

  // Returns the angles of legs, arms and hands (not of the neck). Before 0 and after the end: the first and
  // the last pose, which stand.
  JointAngles at(double time_s) const;
  // Motion that aborts the pickup: from at(from_s) back to home() with the hand open. `time_s`: 0 to
  // kGiveUp_s.
  JointAngles back(double from_s, double time_s) const;
  static constexpr double kGiveUp_s = 3.4;

 private:
  enum Part { kStart, kBent, kRest, kDown, kRested, kClosed, kFirm, kLifted, kEnd };
  struct Key {  // keyframe
    double time = 0;
    // Height of the hips, pitch of the trunk, x of the center of mass.
    double z = 0, pitch = 0, com_x = 0;
    ArmAngles arm, other;  // the arm that picks up, and the other arm, which is a counterweight
    double hand = 0;
  };
  static JointAngles solve(const Key& key, Side hand, double* hips_x = nullptr);
  static Key between(const Key& a, const Key& b, double u);
  static std::optional<ArmAngles> arm_onto(Key key, Side hand, const Eigen::Vector2d& ball,
                                           double radius);
  Key key_at(double time_s) const;

  Side hand_ = Side::right;
  double radius_ = 0, closed_ = 0, stopped_ = 0;
  std::vector<Key> keys_;
};

}  // namespace kaz::motion
