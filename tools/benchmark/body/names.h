// Loads and steppers that the benchmark of the body measures. To add a stepper, add a string here.
// SPDX-License-Identifier: Apache-2.0
//
// The stepper "mujoco" (tools/benchmark/mujoco) is only for comparison.
#pragma once

#include <array>
#include <string>

namespace kaz::sim::bench {

inline constexpr std::array kSteppers{"reduced", "exact", "quick8", "quick20", "quick50", "mujoco"};
// Standing in the walking crouch, walking on the spot, and the same with ten props and a ball.
inline constexpr std::array kLoads{"alone", "walking", "props"};
// Loads for which loading and cloning is measured, with the default stepper.
inline constexpr std::array kWorldLoads{"walking", "props"};
// Number of worlds of the load `walking` that step in turn. Results: time of one step, and its ratio to that
// of a single world.
inline constexpr int kWorlds = 256;
inline constexpr const char* kWorldsUs = "dynamics.worlds_256_us";
inline constexpr const char* kWorldsX = "dynamics.worlds_256_x";

// Returns "dynamics.WHAT.LOAD.STEPPER", or without the stepper if it does not matter.
inline std::string name_of(const std::string& what, const std::string& load,
                           const std::string& stepper = "") {
  return "dynamics." + what + "." + load + (stepper.empty() ? "" : "." + stepper);
}

}  // namespace kaz::sim::bench
