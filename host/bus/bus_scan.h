// Which servos are on a bus, and how well it carries: reads only, writes nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/link/lateness.h"
#include "shared/servo_bus/registers.h"

namespace kaz::host {

struct ScannedServo {
  int id = 0;
  int number = -1;                          // of its model, as it says itself; -1: it does not
  const servo_bus::Model* model = nullptr;  // null: none of the tables has that number
  // Counts over all pings and readings: requests sent, requests without an answer, damaged answers. `late`
  // counts losses while this machine was late, which are undecided and not in `lost` or `damaged`.
  int requests = 0, lost = 0, damaged = 0, late = 0;
  std::vector<double> round_trips_s;  // from the first byte sent to the last one received
  // As the last reading had it; NAN, -1: not read.
  double volts = NAN, lowest_volts = NAN, celsius = NAN;
  double return_delay_s = NAN;
  int torque = -1;          // 0, 1
  std::uint8_t errors = 0;  // Feetech's status byte; DYNAMIXEL's hardware_error_status
};

struct ScanOptions {
  int first_id = 0, last_id = 252;
  int readings = 20;  // of each servo that is found
  Time within{};      // of an answer, on top of what its bytes take; 0: 8 ms
  std::function<void(int id)> progress = nullptr;
  // The link and the clock of the scan, where they are real; may be null.
  LatenessMeter* lateness = nullptr;
  // Called for each id where nobody answered and this machine was late in all repetitions, as `excuse` says.
  std::function<void(int id, const std::string& excuse)> undecided = nullptr;
};

// At the link's rate, which is that of `baud`. Errors: the link's.
Result<std::vector<ScannedServo>> scan_bus(Link& link, Clock& clock, servo_bus::Protocol protocol,
                                           long baud, const ScanOptions& options);

// The rates that models of the protocol can be set to, the factory's first, then falling.
std::vector<long> bus_rates(servo_bus::Protocol protocol);

// Sentences about a servo, each with what to do: errors that it reports, answers lost and damaged, two servos
// under one id, a pause before answers.
struct ScanRemark {
  bool wrong = false;  // else it works, and could be better
  std::string text;
};
std::vector<ScanRemark> remarks_on(const ScannedServo& servo, servo_bus::Protocol protocol);

}  // namespace kaz::host
