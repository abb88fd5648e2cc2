// Loads and steppers of the dynamics benchmark. To add a stepper, add a string here.
// SPDX-License-Identifier: Apache-2.0
//
// A stepper is a method that computes the physics steps. The stepper "mujoco" (tools/benchmark/mujoco) is
// only for comparison.
#pragma once

#include <array>
#include <string>

namespace kaz::sim::bench {

inline constexpr std::array kSteppers{"reduced", "exact", "quick8", "quick20", "quick50", "mujoco"};
// alone: the robot stands in the walking crouch. walking: the robot walks on the spot. props: the robot walks
// on the spot in a world with ten props and a ball.
inline constexpr std::array kLoads{"alone", "walking", "props"};
// Loads for which the times of loading and cloning a world are measured, with the default stepper.
inline constexpr std::array kWorldLoads{"walking", "props"};
// Number of worlds of the load `walking` that step in turn. kWorldsUs is the time of one step. kWorldsX is
// the ratio of this time to the time of one step of a single world.
inline constexpr int kWorlds = 256;
inline constexpr const char* kWorldsUs = "dynamics.worlds_256_us";
inline constexpr const char* kWorldsX = "dynamics.worlds_256_x";

// Returns the name of a result: "dynamics.WHAT.LOAD.STEPPER". If `stepper` is empty, ".STEPPER" is left out.
inline std::string name_of(const std::string& what, const std::string& load,
                           const std::string& stepper = "") {
  return "dynamics." + what + "." + load + (stepper.empty() ? "" : "." + stepper);
}

}  // namespace kaz::sim::bench
