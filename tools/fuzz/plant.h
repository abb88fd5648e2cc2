// Worlds for the fuzzer: motors without a body, and a wrapper of a world for observing drives and joints.
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

// Creates a world of 18 motors of bench_motor(), without a robot. Each motor has a different inertia on its
// shaft, and stops just beyond the limits of its joint. A step of this world takes a thousandth of the time
// of a step with the robot.
std::unique_ptr<sim::World> make_motor_bench();

// Wraps a world. After each step calls a function with the drives of the step and the resulting states of the
// joints.
using DriveWatch = std::function<void(std::span<const sim::MotorDrive> drives,
                                      std::span<const sim::JointState> joints)>;
std::unique_ptr<sim::World> watched(std::unique_ptr<sim::World> world, DriveWatch watch);

}  // namespace kaz::fuzz
