// Creates and steps the worlds of the table's scenes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>

#include "sim/body/world/plain_models_testing.h"
#include "sim/body/world/staged_world.h"
#include "tests/studies/common/table.h"
#include "tests/studies/dynamics_table/table.h"

namespace kaz::dynamics_table {

inline constexpr double kG = 9.81;     // m/s2
inline constexpr double kStep = 1e-3;  // s
inline constexpr double kVolts = 10;

inline std::unique_ptr<sim::StagedWorld> world_of(const std::string& stepper,
                                                  const sim::WorldModel& around,
                                                  const sim::RobotModel& robot,
                                                  const sim::MotorParams& motor,
                                                  double step_s = kStep) {
  sim::WorldOptions options;
  options.dynamics = stepper;
  options.step_s = step_s;
  // Cannot fail: every world supports the dynamics and step lengths of the table.
  return std::move(sim::make_world(around, robot, motor, options).value());
}

inline void run(sim::World& world, double seconds, std::span<const sim::MotorDrive> drives = {}) {
  const double end = world.time_s() + seconds - world.step_s() / 2;
  while (world.time_s() < end) world.step(drives, kVolts);
}

// Returns the gravity vector in the frame of a floor that rises along -x.
inline Eigen::Vector3d on_slope(double radians) {
  return {kG * std::sin(radians), 0, -kG * std::cos(radians)};
}

inline std::string value(const char* format, double number) {
  return studies::text(format, number);
}

}  // namespace kaz::dynamics_table
