// Records a servo that moves a pendulum of known weight: the logs that servo_fit.h takes.
// SPDX-License-Identifier: Apache-2.0
//
// The servo's law is reduced to what a log states, duty = gain * (goal - position): no D, no I, no least
// duty, no profile. What was set before is put back. Three gains, each with four motions; those of the middle
// gain are held out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hil/servo/servo_log.h"
#include "host/bus/bus_driver.h"
#include "host/link/interrupt.h"

namespace kaz::hil {

struct PendulumOptions {
  servo_bus::Protocol protocol = servo_bus::Protocol::feetech;
  int id = 1;
  double mass_kg = 0, length_m = 0, arm_kg = 0;
  double amplitude_rad = 1.4;  // of the goals, to either side of hanging down
  double seconds = 6;          // of a log
  // Beyond these the torque is switched off, and nothing is recorded.
  double max_celsius = 60, max_amps = 2;
  host::Interrupt* interrupt = nullptr;  // may be null
  std::function<void(double share, const std::string& what)> progress;
};

struct PendulumLog {
  std::string name;  // "fit-p32-wave", "held-p16-chirp"
  bool held_out = false;
  ServoLog log;
  int missing = 0;  // readings that did not come
  // Goals are where the servo's own profile was; else as they were sent.
  bool follows_profile = false;
};

struct PendulumRecord {
  std::string servo;  // "sts3215, id 1"
  std::vector<PendulumLog> logs;
  double celsius = 0, volts = 0, largest_amps = 0;  // highest, lowest, and of the absolute value
};

// Errors: environment, the servo does not answer, or no longer; it reports an error; a limit is exceeded;
// usage, the law of its model is not known, its torque is on, it has no room. Afterwards the torque is off,
// whatever happened, and its registers as they were; where that fails, the error says so.
Result<PendulumRecord> record_pendulum(host::Link& link, host::Clock& clock,
                                       const PendulumOptions& options);

}  // namespace kaz::hil
