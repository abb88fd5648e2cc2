// `kaz bench pendulum`: records logs of a pendulum on a bus servo, for `kaz bench servo`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/servo/pendulum_recorder.h"
#include "tools/app/base/outcome.h"

namespace kaz::tools {

struct PendulumArguments {
  std::string robot;                            // for parse_bus()
  std::optional<servo_bus::Protocol> protocol;  // used if `robot` contains none
  long baud = 0;  // 0: the rate in `robot`, or the servos' factory setting
  hil::PendulumOptions recorder;
  double amplitude_deg = 80;
  std::string out = "kaz-pendulum";
  bool yes = false, json = false;
};

// Records twelve logs, and writes them to the folder with record.json.
Result<bool> record_pendulum_logs(PendulumArguments arguments);

}  // namespace kaz::tools
