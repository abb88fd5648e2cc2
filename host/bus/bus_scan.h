// Finds the servos on a bus and checks the transmission quality. The scan never writes to a servo.
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
  int number = -1;                          // model number as reported by the servo; -1: unknown
  const servo_bus::Model* model = nullptr;  // null: no table of models contains `number`
  // Counts over all pings and readings: requests sent, requests without an answer, and damaged answers.
  // `late` counts requests that failed while this process was delayed (lateness.h). `lost` and `damaged` do
  // not include such failures, because their cause is unknown.
  int requests = 0, lost = 0, damaged = 0, late = 0;
  std::vector<double> round_trips_s;  // times from the first byte sent to the last byte received
  // Values from the newest reading; only lowest_volts is the minimum over all readings. NAN or -1: not read.
  double volts = NAN, lowest_volts = NAN, celsius = NAN;
  double return_delay_s = NAN;
  int torque = -1;          // 0: off; 1: on
  std::uint8_t errors = 0;  // Feetech: status byte; DYNAMIXEL: hardware_error_status
};

struct ScanOptions {
  int first_id = 0, last_id = 252;
  int readings = 20;  // number of readings of each servo that was found
  Time within{};      // timeout of an answer, without the transmission time; 0 selects 8 ms
  // Called before each id of the first pass.
  std::function<void(int id)> progress = nullptr;
  // Measures delays of this process in real time. May be null. If `lateness` is not null, pass the same
  // LatenessMeter to scan_bus() as link and as clock.
  LatenessMeter* lateness = nullptr;
  // Called for each id for which the result is undecided: no servo answered, but this process was delayed in
  // every repetition. `excuse` is the text from LatenessMeter::excuse().
  std::function<void(int id, const std::string& excuse)> undecided = nullptr;
};

// Scans the ids from `options.first_id` to `options.last_id`. `baud` must be equal to the link's bit rate.
// Returns the link's errors.
Result<std::vector<ScannedServo>> scan_bus(Link& link, Clock& clock, servo_bus::Protocol protocol,
                                           long baud, const ScanOptions& options);

// Returns the bit rates of the protocol's models: the factory setting first, then the others in descending
// order.
std::vector<long> bus_rates(servo_bus::Protocol protocol);

// A remark about a servo, often with a remedy. Examples: the servo reports an error, answers are lost or
// damaged, or the servo waits before each answer.
struct ScanRemark {
  bool wrong = false;  // false: the servo works, but could work better
  std::string text;
};
std::vector<ScanRemark> remarks_on(const ScannedServo& servo, servo_bus::Protocol protocol);

}  // namespace kaz::host
