// Standing, walking and turning: leg targets from posture and gyro. One step() per control cycle.
// SPDX-License-Identifier: Apache-2.0
//
// The caller calls step() in each control cycle (10 to 20 ms) with the newest posture. The caller sends the
// returned leg targets to the board. The ramps to these targets should last until the next cycle. Targets for
// head and arms come from the caller, so that one exchange() with the board sends all targets. The gait
// assumes that the arms are near the angles of home(). Commands may be given at any time. The stride of a
// foot changes only at the moment at which the foot passes below the hips. To change from walking to turning,
// or from turning to walking, the robot first stops and stands. The stop takes about one cycle.
//
// With a gyro (Posture::inertial, after Robot::sense_inertial()), the heading is measured and held. Without a
// gyro, the heading is estimated from the strides. The estimate is rough, because rotation depends on the
// friction of the soles (docs/explanation/motion.md). Units: m, rad, s. Headings are positive to the left and
// 0 at the start.
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
  // Both soles slip during a turn. So the gait for turning has a long period. With this period, the robot
  // stays upright on every floor (docs/explanation/motion.md).
  Shape turn{.period = 2.2};
  double stride = 0.040;     // m, largest stride of each foot relative to the hips
  double reach = 0.012;      // m, largest sliding amplitude for turning
  bool use_gyro = true;      // false: ignores the gyro
  bool hold_heading = true;  // true: corrects the heading while walking
  // Policy that corrects the gait during walking; needs gyro and accelerometer. Null: no corrections.
  std::shared_ptr<const BalancePolicy> balance = {};
};

enum class State {
  standing,
  walking,
  turning,
  // Final state. The caller must switch the motors off, set the robot upright, and construct a new Motion.
  fallen,
};

class Motion {
 public:
  using LegTargets = std::array<host::JointTarget, 8>;

  explicit Motion(const Settings& settings = {});

  // Walks `distance` m ahead (negative: back). During the walk, the robot holds a heading: the present
  // heading plus `turned` rad. If the measured heading differs from the heading to hold, the two feet make
  // unequal strides. Unequal strides turn the robot by at most a few degrees per gait cycle.
  void walk(double distance, double turned = 0);
  // Walks until stop(). `stride`: m, at most Settings::stride; negative: back. `heading`: the heading to
  // hold, rad.
  void walk_on(double stride, double heading);
  // Turns on the spot by `angle` rad, positive to the left. The soles slip on the floor.
  void turn(double angle);
  // Stops within one and a half gait cycles.
  void stop();

  // Returns the leg targets for the next cycle. In State::fallen, returns the measured angles. `now`: the
  // present time; the gait advances by the time since the previous call, at most 40 ms.
  LegTargets step(Time now, const host::Posture& posture);

  State state() const { return state_; }
  // Returns whether the robot stands and no command is left. A turn has a maximum number of cycles and can
  // end before the commanded heading is reached, so check heading() afterwards.
  bool idle() const { return state_ == State::standing && wish_ == Wish::stand; }
  bool has_gyro() const { return gyro_; }
  // Time (s) over which the gyro's zero was averaged while the robot stood. For an accurate walk of 1 m, the
  // robot must first stand for 4 s. For a turn of 45 degrees, 1 s is enough.
  double zeroed_s() const { return heading_.zeroed_s(); }
  double heading() const;
  const Place& place() const { return odometry_.place(); }
  // Distance walked since the start, m; steps backward reduce the distance.
  double walked() const { return odometry_.walked(); }
  double roll() const { return roll_; }  // rad, planned roll of the trunk
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
  double reckoned_ = 0;  // rad, heading estimated without a gyro
  double turned_a_support_, amplitude_before_ = 0, heading_before_ = 0;
  double still_s_ = 0, tipped_s_ = 0;
  double forward_g_ = 0, left_g_ = 0;  // smoothed specific force, in g
  std::optional<Time> last_;
  Time last_sample_{};
};

}  // namespace kaz::motion
