// Picking up a ball from the floor with one hand: joint angles over time.
// SPDX-License-Identifier: Apache-2.0
//
// Bend with the arm forward and the hand open, swing the arm down onto the ball, close, lift, stand up:
// the way that worked when the body was designed. The hips' place is solved at each moment so that the
// centre of mass stays where it is planned over the soles. Metres, seconds, radians; x ahead, y left
// from the middle of the ankles, on the floor.
#pragma once

#include <optional>
#include <vector>

#include "host/motion/gait.h"

namespace kaz::motion {

class Pickup {
 public:
  // Where the middle of the ball is, and how large it is. Nothing where the hand does not get there:
  // within_reach() says more simply what it does reach.
  static std::optional<Pickup> plan(Side hand, const Eigen::Vector2d& ball, double radius);
  // The same with the arm aimed anew at where the ball is now seen; nothing where out of reach.
  std::optional<Pickup> aimed_at(const Eigen::Vector2d& ball) const;

  // When each part has ended: bent with the arm forward; arm down; hand closed; arm up; standing.
  double bent_s() const { return keys_[kBent].time; }
  double down_s() const { return keys_[kDown].time; }
  double closed_s() const { return keys_[kClosed].time; }
  double lifted_s() const { return keys_[kLifted].time; }
  double end_s() const { return keys_.back().time; }

  Side hand() const { return hand_; }
  int hand_joint() const { return hand_ == Side::left ? host::l_hand : host::r_hand; }
  // What the hand closes to, and where a ball of this radius stops it, at the latest.
  double closed() const { return closed_; }
  double stopped() const { return stopped_; }

  // Legs, arms and hands; the head is somebody else's. Before 0 and after the end: standing.
  JointAngles at(double time_s) const;
  // From that moment of at() back to home(), hand open: of how it is given up. 0..give_up_s().
  JointAngles back(double from_s, double time_s) const;
  static constexpr double kGiveUp_s = 3.4;

 private:
  enum Part { kStart, kBent, kRest, kDown, kRested, kClosed, kFirm, kLifted, kEnd };
  struct Key {  // reached at its time
    double time = 0;
    double z = 0, pitch = 0, com_x = 0;  // of hips, trunk and centre of mass
    ArmAngles arm, other;                // the one that picks up, the counterweight
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
