// What the benchmark of the body measures: loads and steppers. A further stepper is one string here.
// SPDX-License-Identifier: Apache-2.0
//
// For comparison alone: "bulletN", Bullet's multibody with N iterations (tools/benchmark/bullet), and
// "mujoco" (tools/benchmark/mujoco).
#pragma once

#include <array>
#include <string>

namespace kaz::sim::bench {

inline constexpr std::array kSteppers{"reduced", "exact",    "quick8",   "quick20",
                                      "quick50", "bullet10", "bullet50", "mujoco"};
// Standing in the walking crouch; walking on the spot; the same among ten props and a ball.
inline constexpr std::array kLoads{"alone", "walking", "props"};
// Of them, those that are loaded and cloned, with the default stepper.
inline constexpr std::array kWorldLoads{"walking", "props"};
// Worlds of the load `walking` that step in turn: a step of one of them, and over a step of one alone.
inline constexpr int kWorlds = 256;
inline constexpr const char* kWorldsUs = "dynamics.worlds_256_us";
inline constexpr const char* kWorldsX = "dynamics.worlds_256_x";

// "dynamics.WHAT.LOAD.STEPPER", and without the stepper where it does not matter.
inline std::string name_of(const std::string& what, const std::string& load,
                           const std::string& stepper = "") {
  return "dynamics." + what + "." + load + (stepper.empty() ? "" : "." + stepper);
}

}  // namespace kaz::sim::bench
