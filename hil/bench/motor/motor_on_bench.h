// Drives one motor on the bench, open-loop or by its control loop, and records what the potentiometer
// measures.
// SPDX-License-Identifier: Apache-2.0
//
// Every call throws Lost if the link or the stand is lost; this exception ends the bench. Every call throws
// Failed if the board does not execute a request; this exception ends only the measurement.
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
  double t_s = 0;        // board time since the drive or the step began
  double angle_rad = 0;  // angle that the board reports
  double volts = 0;      // voltage at the terminals of the motor drivers
};
using Trace = std::vector<Sample>;

class MotorOnBench {
 public:
  // `stand` may be null. The robot's link watchdog must be 0.5 s or more. The constructor sets the joint's
  // gains to `gains`, and resets the joint's limits to their default values. The destructor restores the
  // previous gains and limits.
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
  double lower_rad() const { return lower_; }  // lower end of the joint's range
  double upper_rad() const { return upper_; }
  double middle_rad() const { return 0.5 * (lower_ + upper_); }

  // Switches all motors off and clears a latched shutdown. Each measurement starts from this state.
  void come_to_rest();
  // Sets the stand's supply. Throws Failed if the supply voltage that the board reads differs from `volts` by
  // more than 0.2 V plus 3 % of `volts`. All motors must be off.
  void set_supply(double volts);
  void wait(double length_s);
  // Moves the joint to the angle by the control loop, then switches the motor off.
  void go_to(double angle_rad);
  // Throws Failed if the board has no valid reading of the potentiometer. Without a valid reading, the board
  // keeps reporting the last valid angle. Such a constant angle looks like a reading without noise.
  void check_potentiometer();
  // Returns the potentiometer code, 0 to 1023, of an angle. Uses the current calibration.
  double potentiometer_code(double angle_rad);
  // Returns a text about the line errors since the previous call. The text is empty if there were no line
  // errors.
  std::string take_line_trouble();
  // Samples the potentiometer every 5 ms with the motor off.
  Trace watch(double length_s);
  // Drives with a duty of -1 to 1, rounded to 1/255, for `length_s`. If `within_rad` is above 0, the drive
  // ends early as soon as the joint is less than `within_rad` from the end of its range. After the drive, the
  // motor is off, and sampling continues for `after_s`.
  Trace drive(double duty, double length_s, double within_rad = 0, double after_s = 0);
  // Like drive(), but ends as soon as the angle differs from `from_rad` by `enough_rad` in either direction.
  Trace nudge(double duty, double length_s, double from_rad, double enough_rad);
  // Starts a drive and returns at once, without sampling. To continue the drive, call this function again
  // before the drive ends.
  void keep_driving(double duty, double length_s);
  // Returns the response of the control loop to a step of the target. The step begins at rest at `from_rad`.
  Trace step(double from_rad, double to_rad, double length_s);
  struct Sine {
    Trace target, answer;
  };
  // Moves the target along a sine around `middle_rad`, and records the targets and the measured angles. A new
  // target is sent every 10 ms.
  Sine follow(double middle_rad, double amplitude_rad, double hertz, double length_s);

 private:
  // Returns the value of `result`, or throws an exception if `result` is an error. If the board still answers
  // (for example after a refusal), the exception is Failed. If the board no longer answers, the exception is
  // Lost.
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
  // Collects samples. The collection ends when the host's clock reaches the time `until`, or earlier as soon
  // as `enough` returns true. `until_s` is the end in board time, in seconds after begin_tick. A busy machine
  // reads frames late. Therefore collect() also checks the samples' board times. At the time `until`, a
  // sample from the last 15 ms before `until_s` should have arrived. If not, collect() waits up to 100 ms
  // longer for such a sample.
  template <class Enough>
  void collect(Trace& to, std::uint32_t begin_tick, Time until, double until_s, Enough enough);

  host::Robot& robot_;
  Stand* stand_;
  int joint_;
  host::Gains gains_, own_gains_;
  double lower_ = 0, upper_ = 0;
  // Limits that the constructor replaced; nullopt if the joint already had the default limits.
  std::optional<host::Limits> own_limits_;
  bool listening_ = false;
  Time unlocked_until_{};
  bool link_lost_ = false;
  std::uint64_t frames_lost_ = 0;  // number of lost telemetry frames
  host::LinkStatistics counted_;   // counts at the last take_line_trouble()
};

// Returns the mean angle; throws Failed if there are no samples.
double mean_angle(const Trace& trace);
// Returns the mean voltage of the samples from `from_s` to `to_s`; throws Failed if there are no samples.
double mean_volts(const Trace& trace, double from_s, double to_s);

}  // namespace kaz::hil
