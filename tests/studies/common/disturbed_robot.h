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

// Streams of keyed_normal (shared/base/random.hpp), one for each quantity that varies.
enum class Noise : std::uint64_t { mass = 101, gain, friction, start, heading, ball, push };
// Standard normal variate `number` of the stream.
double noise(std::uint64_t seed, Noise what, std::uint64_t number);

enum class Motors {
  product,  // motor.xml
  ideal,    // motor.xml without backlash and heating
  reference,  // of the simulator where the gait was found: friction 0.05 Nm, no stiction, 2.16 Nm at 10 V
};

struct Surroundings {
  double mu = 0.7;                      // friction of the floor, mean over seeds
  double mu_spread = 0.15;              // standard deviation relative to `mu`
  std::optional<Eigen::Vector2d> ball;  // position of a ball of 40 mm and 15 g, m
  Motors motors = Motors::product;
};

// Robot and world in a temporary folder that the object owns. Link masses (and inertias) vary with a standard
// deviation of 5 %, floor friction with `mu_spread`. `robot`: folder of kaz.urdf and its companions.
// Errors: a file that cannot be read or written.
Result<trials::RobotFolder> disturbed_files(const std::string& robot, const Surroundings& around,
                                            std::uint64_t seed);

}  // namespace kaz::studies
