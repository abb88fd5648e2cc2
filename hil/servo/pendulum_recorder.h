// Records a servo that moves a pendulum of known weight, as logs for servo_fit.h.
// SPDX-License-Identifier: Apache-2.0
//
// The servo's control law is reduced to that of a log, duty = gain * (goal - position): no D, no I, no
// minimum duty, no profile. Previous settings are restored. Four motions are recorded with each of three
// gains. The logs of the middle gain are held out.
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
  // Beyond these limits the torque is switched off, and the recording ends with an error.
  double max_celsius = 60, max_amps = 2;
  host::Interrupt* interrupt = nullptr;  // may be null
  std::function<void(double share, const std::string& what)> progress;
};

struct PendulumLog {
  std::string name;  // "fit-p32-wave", "held-p16-chirp"
  bool held_out = false;
  ServoLog log;
  int missing = 0;  // number of missing readings
  // True if the goals are those of the servo's own profile; false if they are the goals that were sent.
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
// - usage: the law of its model is unknown, its torque is on, or it has no room to move.
// Afterwards the torque is off and the registers are restored, also after an error or an interrupt. If this
// fails, the error contains it.
Result<PendulumRecord> record_pendulum(host::Link& link, host::Clock& clock,
                                       const PendulumOptions& options);

}  // namespace kaz::hil
