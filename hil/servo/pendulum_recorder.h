// Records a servo that moves a pendulum of known weight. servo_fit.h uses the logs.
// SPDX-License-Identifier: Apache-2.0
//
// The logs assume the control law duty = gain * (goal - position). So the recorder sets the servo's other
// gains, its minimum duty and its acceleration limit to 0. At the end the recorder restores the previous
// settings. Four motions are recorded with each of three gains. The logs with the middle gain are held out
// from the fit.
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
  double amplitude_rad = 1.4;  // maximum angle between the goal and straight down
  double seconds = 6;          // duration of each log
  // If a reading exceeds one of these limits, the torque is switched off, and the recording ends with an
  // error.
  double max_celsius = 60, max_amps = 2;
  host::Interrupt* interrupt = nullptr;  // may be null
  std::function<void(double share, const std::string& what)> progress;
};

struct PendulumLog {
  std::string name;  // name of the log, such as "fit-p32-wave" or "held-p16-chirp"
  bool held_out = false;
  ServoLog log;
  int missing = 0;  // number of missing readings
  // If true, the servo follows its own motion profile. The goals in the log are then the setpoints of this
  // profile, as read from the servo. If false, the goals in the log are the goals that the recorder sent.
  bool follows_profile = false;
};

struct PendulumRecord {
  std::string servo;  // model and id of the servo, such as "sts3215, id 1"
  std::vector<PendulumLog> logs;
  // Highest temperature, lowest voltage and highest absolute current in all logs.
  double celsius = 0, volts = 0, largest_amps = 0;
};

// Records all logs. Errors:
// - environment: the servo reports an error or does not answer, or a limit is exceeded.
// - usage: the control law of the servo's model is unknown, the torque is on, or the swing exceeds the
//   servo's range.
// If the torque is on at the start, record_pendulum() leaves the servo unchanged. After a recording,
// record_pendulum() switches the torque off and restores the registers, even if the recording ends with an
// error or an interrupt. If the torque cannot be switched off or a register cannot be restored, the error
// message says so.
Result<PendulumRecord> record_pendulum(host::Link& link, host::Clock& clock,
                                       const PendulumOptions& options);

}  // namespace kaz::hil
