// For tests: runs the motor measurements on a simulated board on the virtual stand.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "sim/board/sensor_file.h"
#include "tests/integration/bench/measured_testing.h"
#include "tools/lockstep/stand_backend.h"

namespace kaz::hil {

inline sim::MotorParams kaz_motor() {
  const auto motor =
      sim::load_motor_file(std::string(KAZ_TREE) + "/shared/robot/kaz/motor.xml", "");
  EXPECT_TRUE(motor) << motor.error().message;
  return *motor;
}

inline sim::SimulationOptions kaz_board() {
  sim::SimulationOptions board;
  const auto params =
      sim::load_sensor_file(std::string(KAZ_TREE) + "/shared/robot/kaz/sensors.xml");
  EXPECT_TRUE(params) << params.error().message;
  board.sensor_params = *params;
  return board;
}

// A motor under test, its board and its stand, with faults.
struct MotorTest {
  sim::MotorParams motor = kaz_motor();
  sim::SimulationOptions board = kaz_board();
  MotorBenchOptions options;
  Limits limits;
  double disc_kgm2 = 4e-4;
  // Gain of the scale for positive torques: reading over true torque.
  double scale_forward = 1;
  bool with_stand = true;
  std::string inside;  // faults of the simulated motor, in the format of a fault file
  // Changes the board before the measurement. May be null.
  std::function<void(host::Robot&)> prepare;
};

// Runs the measurements. Errors are test failures.
BenchReport measure_motor(const MotorTest& test);

}  // namespace kaz::hil
