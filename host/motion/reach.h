// Trajectory for picking up a ball from the floor with one hand: joint angles over time.
// SPDX-License-Identifier: Apache-2.0
//
// First, the robot bends forward with the arm ahead and the hand open. Then the robot swings the arm down
// onto the ball, closes the hand, lifts the arm, and stands up. At each time, the hips are placed so that the
// center of mass is over the planned point of the soles (static balance). Units: m, s, rad. Frame: origin on
// the floor below the midpoint of the ankles, x ahead, y left, z up.
#pragma once

#include <optional>
#include <vector>

#include "host/motion/gait.h"

namespace kaz::motion {

class Pickup {
 public:
  // `ball`: position of the ball's center, seen from above. Returns nothing if the ball is out of reach.
  static std::optional<Pickup> plan(Side hand, const Eigen::Vector2d& ball, double radius);
  // Returns a copy of this plan for a new position of the ball. Returns nothing if the ball is out of reach.
  std::optional<Pickup> aimed_at(const Eigen::Vector2d& ball) const;

  // Times at which these postures are reached: bent with the arm forward; arm down; hand closed; arm up;
  // standing.
  double bent_s() const { return keys_[kBent].time; }
  double down_s() const { return keys_[kDown].time; }
  double closed_s() const { return keys_[kClosed].time; }
  double lifted_s() const { return keys_[kLifted].time; }
  double end_s() const { return keys_.back().time; }

  Side hand() const { return hand_; }
  int hand_joint() const { return hand_ == Side::left ? host::l_hand : host::r_hand; }
  // Returns the target angle of the closing hand, rad.
  double closed() const { return closed_; }
  // Returns the largest angle of the hand joint at which the ball can be in the hand, rad. The angle of the
  // hand joint increases while the hand closes. If the angle exceeds stopped(), the ball is not in the hand.
  double stopped() const { return stopped_; }

  // Returns the angles of legs, arms and hands (not of the neck). Before time 0, returns the first pose.
  // After the end, returns the last pose. In both poses, the robot stands.
  JointAngles at(double time_s) const;
  // Returns the joint angles of the motion that aborts the pickup. This motion begins with the pose that
  // `at(from_s)` returns, opens the hand, and ends at home(). `time_s`: time since the start of this motion,
  // 0 to kGiveUp_s.
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
