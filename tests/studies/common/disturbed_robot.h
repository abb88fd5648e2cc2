// Robot and world files with random variations by seed: link masses, floor friction, motors.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "tools/trials/robot_folder.h"

namespace kaz::studies {

// Streams of keyed_normal (shared/base/random.hpp), one for each varied quantity.
enum class Noise : std::uint64_t { mass = 101, gain, friction, start, heading, ball, push };
// Returns the standard normal variate `number` of a stream.
double noise(std::uint64_t seed, Noise what, std::uint64_t number);

enum class Motors {
  product,  // motor.xml
  ideal,    // motor.xml without backlash and heating
  // Motors of the simulator in which the gait was found: ideal, with friction 0.05 Nm, no stiction, and a
  // stall torque of 2.16 Nm at 10 V.
  reference,
};

struct Surroundings {
  double mu = 0.7;                      // friction of the floor, mean over seeds
  double mu_spread = 0.15;              // standard deviation relative to `mu`
  std::optional<Eigen::Vector2d> ball;  // position of a ball with 40 mm diameter and 15 g, m
  Motors motors = Motors::product;
};

// Writes robot and world to a temporary folder that the result owns. Link masses and inertias vary with a
// standard deviation of 5 %, floor friction with `mu_spread` but not below 20 % of `mu`. `robot`: folder of
// kaz.urdf and its companions. Errors: a file cannot be read or written.
Result<trials::RobotFolder> disturbed_files(const std::string& robot, const Surroundings& around,
                                            std::uint64_t seed);

}  // namespace kaz::studies
