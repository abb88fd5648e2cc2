// How a run was put together, as its recording states it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "shared/base/result.hpp"
#include "sim/runtime/formats/mcap_reader.h"

namespace kaz::tools {

struct RecordedBackend {
  std::string behavior;
  std::map<std::string, std::string> settings;  // of the behaviour
  // As BackendOptions has them.
  std::string world, robot_file, mcu, image, sensors, eyes;
  std::string dynamics = "reduced";
  bool imu = false;
  double physics_step_ms = 1, supply_volts = 10;
  int eye_width = 0;
  std::uint64_t seed = 1;
};

// `name`: of the recording, for the errors (usage): it does not state its backend, or not as kaz does.
Result<RecordedBackend> recorded_backend(const sim::McapRecording& recording,
                                         const std::string& name);

}  // namespace kaz::tools
