// One motor on the bench: driven, left alone, led by its loop, and what its potentiometer measured
// meanwhile.
// SPDX-License-Identifier: Apache-2.0
//
// Every call ends the bench (Lost) when the link or the stand is gone, and the measurement (Failed)
// when the board does not execute a request.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/bench/motor/stand.h"
#include "hil/report/check.h"
#include "host/robot/robot.h"

namespace kaz::hil {

struct Sample {
  double t_s = 0;        // by the board's clock, since the drive or the step began
  double angle_rad = 0;  // as the board reports it
  double volts = 0;      // at the drivers' terminals
};
using Trace = std::vector<Sample>;

class MotorOnBench {
 public:
  // `stand` may be null. The robot's link watchdog must be 0.5 s or more. The joint gets these gains, and
  // the limits that it has after a reset; it has its own again afterwards.
  MotorOnBench(host::Robot& robot, Stand* stand, int joint, const host::Gains& gains);
  ~MotorOnBench();
  MotorOnBench(const MotorOnBench&) = delete;
  MotorOnBench& operator=(const MotorOnBench&) = delete;

  host::Robot& robot() { return robot_; }
  bool has_stand() const { return stand_ != nullptr; }
  Stand& stand() { return *stand_; }
  int joint() const { return joint_; }
  std::string name() const;
  const host::Gains& gains() const { return gains_; }
  double lower_rad() const { return lower_; }  // of the joint's range
  double upper_rad() const { return upper_; }
  double middle_rad() const { return 0.5 * (lower_ + upper_); }

  // All motors off and nothing latched. The same before each measurement.
  void come_to_rest();
  // The stand's supply; Failed if the board, with its motors off, reads another.
  void set_supply(double volts);
  void wait(double length_s);
  // By the loop, then off.
  void go_to(double angle_rad);
  // Failed if the board has no valid reading of the potentiometer now: it then keeps the last angle, which
  // looks like a reading without noise.
  void check_potentiometer();
  // 0 to 1023, by the calibration in use.
  double potentiometer_code(double angle_rad);
  // What befell the line since the last call, as "on the line 3 replies did not come"; empty: nothing.
  std::string take_line_trouble();
  // Motor off: samples of its potentiometer every 5 ms.
  Trace watch(double length_s);
  // Duty -1..1, rounded to 1/255, for that long or, with a shaft that may turn, until it has come
  // `within_rad` of the limit it runs to; then off, and watched for `after_s` more.
  Trace drive(double duty, double length_s, double within_rad = 0, double after_s = 0);
  // The same, and off as soon as the angle is `enough_rad` from `from_rad` on either side.
  Trace nudge(double duty, double length_s, double from_rad, double enough_rad);
  // Without watching: a drive that goes on from the one before.
  void keep_driving(double duty, double length_s);
  // The loop's answer to a step of the target, from rest at `from`.
  Trace step(double from_rad, double to_rad, double length_s);
  struct Sine {
    Trace target, answer;
  };
  // The loop led along middle + amplitude sin(2 pi f t), a new target every 10 ms.
  Sine follow(double middle_rad, double amplitude_rad, double hertz, double length_s);

 private:
  // A refusal fails the measurement: the board is there.
  template <class T>
  T or_throw(Result<T> result) {
    if (result) return sure(std::move(result));
    if (robot_.health()) throw Failed{result.error().message};
    link_lost_ = result.error().fault == Fault::environment;
    throw Lost{result.error()};
  }
  void unlock();
  void listen(bool on);
  template <class Enough>
  Trace drive_until(double duty, double length_s, double after_s, Enough enough);
  void forget_telemetry();
  // Until `until` on the host's clock, or as soon as `enough` returns true. Frames of the board's time before
  // until_s, s after begin_tick, are waited for a little longer: on a busy machine they are read late.
  template <class Enough>
  void collect(Trace& to, std::uint32_t begin_tick, Time until, double until_s, Enough enough);

  host::Robot& robot_;
  Stand* stand_;
  int joint_;
  host::Gains gains_, own_gains_;
  double lower_ = 0, upper_ = 0;
  std::optional<host::Limits> own_limits_;  // if they were others
  bool listening_ = false;
  Time unlocked_until_{};
  bool link_lost_ = false;
  std::uint64_t frames_lost_ = 0;  // of telemetry
  host::LinkStatistics counted_;   // by take_line_trouble()
};

// Mean of the samples' angles; Failed if there are none.
double mean_angle(const Trace& trace);
// Mean of the volts of the samples from t on.
double mean_volts(const Trace& trace, double from_s, double to_s);

}  // namespace kaz::hil
