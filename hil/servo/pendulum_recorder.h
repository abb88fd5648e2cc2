// Records a servo that moves a pendulum of known weight, as logs for servo_fit.h.
// SPDX-License-Identifier: Apache-2.0
//
// The recorder sets the servo's control law to the law of a log, duty = gain * (goal - position), without D,
// I, minimum duty and profile. At the end the recorder restores the previous settings. Four motions are
// recorded with each of three gains. The logs of the middle gain are held out.
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
  double amplitude_rad = 1.4;  // maximum goal to either side of hanging down
  double seconds = 6;          // duration of a log
  // If a reading exceeds one of these limits, the torque is switched off, and the recording ends with an
  // error.
  double max_celsius = 60, max_amps = 2;
  host::Interrupt* interrupt = nullptr;  // may be null
  std::function<void(double share, const std::string& what)> progress;
};

struct PendulumLog {
  std::string name;  // "fit-p32-wave", "held-p16-chirp"
  bool held_out = false;
  ServoLog log;
  int missing = 0;  // number of missing readings
  // True if the log contains the goals of the servo's own profile, false if it contains the goals that were
  // sent.
  bool follows_profile = false;
};

struct PendulumRecord {
  std::string servo;  // "sts3215, id 1"
  std::vector<PendulumLog> logs;
  // Highest temperature, lowest voltage, highest absolute current.
  double celsius = 0, volts = 0, largest_amps = 0;
};

// Records all logs. Errors:
// - environment: the servo does not answer or reports an error, or a limit is exceeded.
// - usage: the control law of the servo's model is unknown, the torque is on, or the servo has no room to
//   move.
// Afterwards the torque is off and the registers are restored, also after an error or an interrupt. If
// switching off or restoring fails, the error message says so.
Result<PendulumRecord> record_pendulum(host::Link& link, host::Clock& clock,
                                       const PendulumOptions& options);

}  // namespace kaz::hil
