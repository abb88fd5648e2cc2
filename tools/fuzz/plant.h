// Worlds for the fuzzer: motors without a body, and a world whose drives and joints are watched.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "sim/body/description/motor_file.h"
#include "sim/body/world/world.h"

namespace kaz::fuzz {

// The default of shared/robot/kaz/motor.xml, for a program that finds no files.
sim::MotorParams bench_motor();

// Eighteen of them, each with an inertia of its own on its shaft and stops at the ends of the
// joint's range:
// a thousandth of the cost of the robot.
std::unique_ptr<sim::World> make_motor_bench();

// Calls `watch` after each step, with what the motors were given.
using DriveWatch = std::function<void(std::span<const sim::MotorDrive> drives,
                                      std::span<const sim::JointState> joints)>;
std::unique_ptr<sim::World> watched(std::unique_ptr<sim::World> world, DriveWatch watch);

}  // namespace kaz::fuzz
