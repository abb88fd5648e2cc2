// Measures the round-trip time of a port and diagnoses a slow one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/port_link.h"
#include "host/robot/robot.h"

namespace kaz::host {

struct RoundTripCheck {
  double round_trip_s = 0;  // median of several heartbeats
  double expected_s = 0;    // their bytes on the wire, and the 2.2 ms that a board may take
  bool slow = false;        // more than 2 ms beyond that
  std::string sentence;     // "round trip on /dev/kaz: 4.1 ms", and what to do if it is slow
};

Result<RoundTripCheck> measure_round_trip(Robot& robot, const PortLink& port);

// The evaluation alone, for tests of all kinds of ports.
RoundTripCheck judge_round_trip(const std::string& port, double round_trip_s, Time byte_time,
                                LowLatency low_latency);

}  // namespace kaz::host
