// `kaz bench pendulum`: records logs of a pendulum on a bus servo, for `kaz bench servo`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/servo/pendulum_recorder.h"
#include "tools/base/exit_status.h"

namespace kaz::tools {

struct PendulumArguments {
  std::string robot;                            // bus and port, as for parse_bus()
  std::optional<servo_bus::Protocol> protocol;  // protocol to use if `robot` contains no protocol
  long baud = 0;  // baud rate; 0: the rate in `robot`, or the servos' factory setting
  hil::PendulumOptions recorder;
  double amplitude_deg = 80;
  std::string out = "kaz-pendulum";
  bool yes = false, json = false;
};

// Records twelve logs. Writes the logs and record.json to the folder `out`.
Result<bool> record_pendulum_logs(PendulumArguments arguments);

}  // namespace kaz::tools
