// Standing, walking and turning: leg targets from posture and gyro, one step() per control cycle.
// SPDX-License-Identifier: Apache-2.0
//
// The caller calls step() in each control cycle (10 to 20 ms) with the newest posture and sends the leg
// targets it returns, ramped over the time to the next cycle. Head and arms are the caller's: the gait
// counts on the arms of home() or close to them. Commands may come at any time; a foot's stride changes
// only when it passes below the hips, and from walking to turning it goes through standing (about one
// cycle). Head, arms and Motion share one exchange() with the board.
//
// With gyro (Posture::inertial, after Robot::sense_inertial()) heading is measured and held. Without,
// it is reckoned from the strides, which friction decides (docs/explanation/motion.md): rough.
// Metres, radians, seconds; headings + to the left, 0 where it began.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "host/motion/balance.h"
#include "host/motion/gait.h"
#include "host/motion/heading.h"
#include "host/motion/odometry.h"
#include "host/robot/robot_types.h"

namespace kaz::motion {

struct Settings {
  Shape walk{};
  // Turning slips both soles: slowly, and with the lean that holds on every floor
  // (docs/explanation/motion.md).
  Shape turn{.period = 2.2};
  double stride = 0.040;     // m, of each foot relative to the hips; the maximum used
  double reach = 0.012;      // m, of turning
  bool use_gyro = true;      // false: as if the board had none
  bool hold_heading = true;  // while walking
  // Corrects the gait while walking; needs gyro and accelerometer. None: the gait follows time alone.
  std::shared_ptr<const BalancePolicy> balance = {};
};

enum class State {
  standing,
  walking,
  turning,
  fallen,  // for good: switch the motors off, set the robot up, make a new Motion
};

class Motion {
 public:
  using LegTargets = std::array<host::JointTarget, 8>;

  explicit Motion(const Settings& settings = {});

  // Walks `distance` m ahead (negative: back), and holds the present heading plus `turned` rad. Heading
  // errors are corrected by unequal strides, at most 2 degrees a cycle.
  void walk(double distance, double turned = 0);
  // Until stop(): with that stride (at most Settings::stride, negative: back), holding a heading.
  void walk_on(double stride, double heading);
  // On the spot, by slip of the soles.
  void turn(double angle);
  // To a stand, within a cycle and a half.
  void stop();

  // `now`: when the next targets will have been reached. Joints: those of the legs.
  LegTargets step(Time now, const host::Posture& posture);

  State state() const { return state_; }
  // Standing, and nothing left to do. A turn that took too many cycles ends, too: see the heading.
  bool idle() const { return state_ == State::standing && wish_ == Wish::stand; }
  bool has_gyro() const { return gyro_; }
  // Standing still so long, s, while the gyro's zero was averaged: 4 s for a metre, 1 s for 45
  // degrees.
  double zeroed_s() const { return heading_.zeroed_s(); }
  double heading() const;
  const Place& place() const { return odometry_.place(); }
  double walked() const { return odometry_.walked(); }  // m since the start, back is negative
  double roll() const { return roll_; }                 // rad, planned of the trunk
  double phase() const { return phase_; }
  double amplitude() const { return steps_.amplitude; }

 private:
  enum class Wish { stand, walk, turn };
  const Shape& shape() const { return state_ == State::turning ? settings_.turn : settings_.walk; }
  void sense(const host::Posture& posture);
  void watch_for_a_fall(const host::Inertial& sample, double dt);
  void begin(State state);
  void advance(double dt);
  void half_cycle();
  void choose_strides();
  void choose_reach();
  void reckon_strides();
  void count_turn();
  LegTargets targets(const host::Posture& posture);
  void keep_balance(const host::Posture& posture, double dt);

  Settings settings_;
  double walk_roll_, turn_roll_;
  State state_ = State::standing;
  Wish wish_ = Wish::stand;
  bool endless_ = false, ending_ = false, gyro_ = false, turned_enough_ = false;
  double goal_walked_ = 0, goal_heading_ = 0, stride_ = 0;
  double phase_ = 0, roll_ = 0;
  int halves_ = 0;
  Steps steps_;
  std::optional<Balance> balance_;
  Correction correction_;
  Heading heading_;
  Odometry odometry_;
  double reckoned_ = 0;  // rad, heading without a gyro
  double turned_a_support_, amplitude_before_ = 0, heading_before_ = 0;
  double still_s_ = 0, tipped_s_ = 0;
  double forward_g_ = 0, left_g_ = 0;  // smoothed specific force, in g
  std::optional<Time> last_;
  Time last_sample_{};
};

}  // namespace kaz::motion
