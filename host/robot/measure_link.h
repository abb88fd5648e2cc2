// Measures the round-trip time of a port and explains a slow round trip.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/port_link.h"
#include "host/robot/robot.h"

namespace kaz::host {

struct RoundTripCheck {
  double round_trip_s = 0;  // median of several heartbeats
  double expected_s = 0;    // transmission time of heartbeat and reply, plus 2.2 ms for the board
  bool slow = false;        // true: round_trip_s is more than 2 ms above expected_s
  // Text for the user, such as "round trip on /dev/kaz: 4.1 ms (...)". If `slow` is true, the text includes a
  // remedy.
  std::string sentence;
};

// Sends heartbeats to the board and evaluates their round trips. Returns the errors of Robot::heartbeat.
Result<RoundTripCheck> measure_round_trip(Robot& robot, const PortLink& port);

// Evaluates a measured round trip. This function is separate from the measurement, so that tests can cover
// all kinds of ports. `byte_time` may be zero (unknown).
RoundTripCheck judge_round_trip(const std::string& port, double round_trip_s, Time byte_time,
                                LowLatency low_latency);

}  // namespace kaz::host
