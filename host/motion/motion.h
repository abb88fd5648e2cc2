// Standing, walking and turning: leg targets from posture and gyro. One step() per control cycle.
// SPDX-License-Identifier: Apache-2.0
//
// The caller calls step() in each control cycle (10 to 20 ms) with the newest posture. It sends the
// returned leg targets, ramped over the time to the next cycle. Head and arms are the caller's, so that all
// share one exchange() with the board. The gait assumes arms at home() or close to it. Commands may come at
// any time. A foot's stride changes only when it passes below the hips. The robot changes between walking
// and turning through standing, in about one cycle.
//
// With a gyro (Posture::inertial, after Robot::sense_inertial()), heading is measured and held. Without, it
// is estimated from the strides. This is rough, because friction decides (docs/explanation/motion.md).
// Units: m, rad, s. Headings are + to the left, 0 at the start.
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
  // Turning slips both soles. So it is slow, with a lean that holds on every floor
  // (docs/explanation/motion.md).
  Shape turn{.period = 2.2};
  double stride = 0.040;     // m, largest stride of each foot relative to the hips
  double reach = 0.012;      // m, largest sliding amplitude for turning
  bool use_gyro = true;      // false: ignores the gyro
  bool hold_heading = true;  // while walking
  // Policy that corrects the gait during walking; needs gyro and accelerometer. Null: no corrections.
  std::shared_ptr<const BalancePolicy> balance = {};
};

enum class State {
  standing,
  walking,
  turning,
  // Final: switch the motors off, set the robot up, and make a new Motion.
  fallen,
};

class Motion {
 public:
  using LegTargets = std::array<host::JointTarget, 8>;

  explicit Motion(const Settings& settings = {});

  // Walks `distance` m ahead (negative: back) and holds the present heading plus `turned` rad. Heading
  // errors are corrected by unequal strides, at most 2 degrees a cycle.
  void walk(double distance, double turned = 0);
  // Walks until stop() with this stride (m, at most Settings::stride, negative: back) and holds a heading
  // (rad).
  void walk_on(double stride, double heading);
  // Turns on the spot by `angle` rad, + to the left. The soles slip on the floor.
  void turn(double angle);
  // Stops within a cycle and a half.
  void stop();

  // Returns the leg targets for the next cycle; in State::fallen, the measured angles. `now`: the time at
  // which the targets will have been reached.
  LegTargets step(Time now, const host::Posture& posture);

  State state() const { return state_; }
  // Returns whether the robot stands and no command is left. A turn also ends after too many cycles, so
  // compare heading() with the commanded heading.
  bool idle() const { return state_ == State::standing && wish_ == Wish::stand; }
  bool has_gyro() const { return gyro_; }
  // Time (s) over which the gyro's zero was averaged while the robot stood. A walk of 1 m needs 4 s, a turn
  // of 45 degrees needs 1 s.
  double zeroed_s() const { return heading_.zeroed_s(); }
  double heading() const;
  const Place& place() const { return odometry_.place(); }
  double walked() const { return odometry_.walked(); }  // m since the start; back is negative
  double roll() const { return roll_; }                 // rad, planned roll of the trunk
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
