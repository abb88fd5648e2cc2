// Measurements of one motor: group `motor` of measurements.def.
// SPDX-License-Identifier: Apache-2.0
//
// The measurements use the host's Robot and a Stand. Therefore the measurements run in the same way on a real
// board and on an emulated board. Without a stand, measurements that need a stand are left out.
// docs/howto/bench.md describes each measurement.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "hil/bench/measurement.h"
#include "hil/bench/motor/motor_on_bench.h"

namespace kaz::hil {

struct MotorBenchOptions {
  int joint = 2;
  std::string filter;  // regular expression for names of measurements; empty: all measurements
  // Gains of the control loop, the same for every joint. By default, hands also get KZ_KP_DEFAULT and
  // KZ_KD_DEFAULT.
  host::Gains gains;
  // Supply voltage of the stand, unless a measurement sets another voltage.
  double supply_volts = 10;
  // `share`: completed share, 0 to 1.
  std::function<void(double share, const std::string& what)> progress;
};

// Returns connection options with a link watchdog of 0.5 s. bench_motor() requires a link watchdog of at
// least 0.5 s.
host::ConnectOptions bench_connection();

// Error (usage): the filter is not a regular expression, or matches no measurement of a motor.
Result<void> check_motor_filter(const std::string& filter);

// Runs the measurements. `stand` may be null. The robot must be connected with a link watchdog of 0.5 s or
// more, and all motors must be off. A measurement that fails is entered as failed, and the next measurement
// follows. If a motor turns in the opposite direction to its potentiometer, the other measurements are left
// out. Errors: the link or the stand is lost (environment); the joint does not exist or the filter is invalid
// (usage).
Result<void> bench_motor(host::Robot& robot, Stand* stand, const MotorBenchOptions& options,
                         BenchJudge& judge);

// The functions below are the parts of the bench, in the order in which they run. Each function enters its
// measurements into the report.
//
// Enters the measurement `direction`. A correct direction is entered only if `enter_good` is true. Returns
// false if the motor turns in the opposite direction to its potentiometer. In that case, the motor must not
// be driven by the control loop.
bool measure_direction(MotorOnBench& motor, BenchJudge& judge, bool enter_good);
void measure_potentiometer_noise(MotorOnBench& motor, BenchJudge& judge);  // enters pot.noise
// Enters all measurements pot.* except pot.noise.
void measure_potentiometer_line(MotorOnBench& motor, BenchJudge& judge);
void measure_backlash(MotorOnBench& motor, BenchJudge& judge);
// Enters dead_band, and also friction.breakaway if the torque per volt (`slope_nm_per_v`) is known. Each
// function with a parameter `supply_volts` sets the stand's supply to this voltage at the end.
void measure_dead_band(MotorOnBench& motor, BenchJudge& judge, double supply_volts,
                       std::optional<double> slope_nm_per_v);
// Enters no_load.* and start.*, and also friction.running if the torque per volt is known.
void measure_speed(MotorOnBench& motor, BenchJudge& judge, std::optional<double> slope_nm_per_v);
void measure_step(MotorOnBench& motor, BenchJudge& judge);       // enters step.*
void measure_frequency(MotorOnBench& motor, BenchJudge& judge);  // enters frequency.*
// Enters stall.* and friction.sliding; returns stall.slope.
double measure_stall(MotorOnBench& motor, BenchJudge& judge, double supply_volts);
void measure_heat(MotorOnBench& motor, BenchJudge& judge, double supply_volts);  // enters thermal.*

}  // namespace kaz::hil
