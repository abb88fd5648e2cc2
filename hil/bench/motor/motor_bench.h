// The measurements of one motor: group `motor` of measurements.def.
// SPDX-License-Identifier: Apache-2.0
//
// Written against the host's Robot and a Stand: the same against a real board and the emulated one.
// Without a stand those that need one are skipped. docs/howto/bench.md describes each.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "hil/bench/measurement.h"
#include "hil/bench/motor/motor_on_bench.h"

namespace kaz::hil {

struct MotorBenchOptions {
  int joint = 2;
  std::string filter;        // regular expression, found in a measurement's name; empty: all
  host::Gains gains;         // of the joint's loop, for all joints alike: the board's, not a hand's
  double supply_volts = 10;  // the stand's, where a measurement does not set its own
  // share: 0..1 done.
  std::function<void(double share, const std::string& what)> progress;
};

// How the robot is to be connected: its link watchdog lets a stand's tools take their time.
host::ConnectOptions bench_connection();

// Error (usage): no regular expression, or one that takes no measurement of a motor.
Result<void> check_motor_filter(const std::string& filter);

// The robot must be connected with a link watchdog of 0.5 s or more; all motors must be off. What
// fails is entered as failed and the next one goes on; where the motor turns against its potentiometer the
// others are left out. Errors: link or stand are gone (environment),
// no such joint or filter (usage).
Result<void> bench_motor(host::Robot& robot, Stand* stand, const MotorBenchOptions& options,
                         BenchJudge& judge);

// The parts, in the order in which they run; each enters what it is named for.
// direction, a good one only with `enter_good`. False: the motor turns against its potentiometer, and no loop
// may be closed on it.
bool measure_direction(MotorOnBench& motor, BenchJudge& judge, bool enter_good);
void measure_potentiometer_noise(MotorOnBench& motor, BenchJudge& judge);  // pot.noise
void measure_potentiometer_line(MotorOnBench& motor, BenchJudge& judge);   // pot.* but noise
void measure_backlash(MotorOnBench& motor, BenchJudge& judge);
// dead_band, and friction.breakaway if the torque for each volt is known. The stand's supply stands at
// `supply_volts` afterwards, here and below.
void measure_dead_band(MotorOnBench& motor, BenchJudge& judge, double supply_volts,
                       std::optional<double> slope_nm_per_v);
// no_load.*, start.*, and friction.running if the torque for each volt is known.
void measure_speed(MotorOnBench& motor, BenchJudge& judge, std::optional<double> slope_nm_per_v);
void measure_step(MotorOnBench& motor, BenchJudge& judge);       // step.*
void measure_frequency(MotorOnBench& motor, BenchJudge& judge);  // frequency.*
// stall.* and friction.sliding; returns stall.slope.
double measure_stall(MotorOnBench& motor, BenchJudge& judge, double supply_volts);
void measure_heat(MotorOnBench& motor, BenchJudge& judge, double supply_volts);  // thermal.*

}  // namespace kaz::hil
