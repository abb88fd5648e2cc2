// Worlds for the fuzzer: motors without a body, and a wrapper that observes drives and joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "sim/body/description/motor_file.h"
#include "sim/body/world/world.h"

namespace kaz::fuzz {

// Returns the default motor of shared/robot/kaz/motor.xml, without reading a file.
sim::MotorParams bench_motor();

// Creates a world of 18 such motors without a robot. Each has its own inertia on the shaft, and stops just
// beyond the joint's limits. It costs a thousandth of the robot's time.
std::unique_ptr<sim::World> make_motor_bench();

// Wraps `world` and calls `watch` after each step, with the drives of the step and the resulting joints.
using DriveWatch = std::function<void(std::span<const sim::MotorDrive> drives,
                                      std::span<const sim::JointState> joints)>;
std::unique_ptr<sim::World> watched(std::unique_ptr<sim::World> world, DriveWatch watch);

}  // namespace kaz::fuzz
