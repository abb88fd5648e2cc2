// The options that say which virtual robot in which world.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "tools/kaz/session_backend.h"

namespace kaz::tools {

// --world, --robot-file, --mcu, --image, --faults, --sensors, --imu, --dynamics,
// --physics-step, --eyes, --eye-width, --seed.
void add_sim_options(CLI::App& verb, BackendOptions& options);
// --motor-file, --motor, --disc: what stands on a virtual motor stand.
void add_motor_options(CLI::App& verb, BackendOptions& options);
// --record-pictures, for verbs that record.
void add_record_pictures(CLI::App& verb, BackendOptions& options);

}  // namespace kaz::tools
