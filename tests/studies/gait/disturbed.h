// Files of a robot and a world that differ a little from seed to seed, as built robots do.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "tools/trials/robot_folder.h"

namespace kaz::gait {

// What a seed's random numbers are for; each has its own stream of keyed_normal.
enum class Noise : std::uint64_t { mass = 101, gain, friction, start, heading, ball, push };
double noise(std::uint64_t seed, Noise what, std::uint64_t number);

enum class Motors {
  product,    // motor.xml as it is
  ideal,      // the same without backlash and heat
  reference,  // as where the gait was found: 0.05 Nm of friction, no stiction, 2.16 Nm at 10 V
};

struct Surroundings {
  double mu = 0.7;                      // of the floor, mean over seeds
  double mu_spread = 0.15;              // one sigma, as a share of it
  std::optional<Eigen::Vector2d> ball;  // where one of 40 mm and 15 g lies, m
  Motors motors = Motors::product;
};

// Robot and world in a folder that goes with the object. Link masses (inertias with them) are off by
// 5 %, friction of the floor by 15 %, one sigma each. `robot`: folder of kaz.urdf and its companions.
// Errors: a file that cannot be read or written.
Result<trials::RobotFolder> disturbed_files(const std::string& robot, const Surroundings& around,
                                            std::uint64_t seed);

}  // namespace kaz::gait
