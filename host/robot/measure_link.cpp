// Some heartbeats, and a sentence about how long they took.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/measure_link.h"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace kaz::host {

namespace {

constexpr int kHeartbeats = 9;
constexpr int kFrameBytes = KZ_FRAME_MAX - KZ_PAYLOAD_MAX;  // all that stands around the fields
constexpr int kBytes = 2 * kFrameBytes + KZ_SIZE_heartbeat + KZ_SIZE_heartbeat_reply;
constexpr double kBoard = 2.2e-3;  // docs/reference/protocol.md, TIME-1
constexpr double kTolerance = 2e-3;

}  // namespace

RoundTripCheck judge_round_trip(const std::string& port, double round_trip_s, Time byte_time,
                                LowLatency low_latency) {
  RoundTripCheck check;
  check.round_trip_s = round_trip_s;
  // Behind a bus or a network is a board's line too, most likely.
  const double byte_s = byte_time > Time::zero() ? seconds(byte_time) : 10.0 / KZ_BAUD;
  check.expected_s = byte_s * kBytes + kBoard;
  check.slow = round_trip_s > check.expected_s + kTolerance;
  char text[160];
  std::snprintf(text, sizeof text, "round trip on %s: %.1f ms (wire and board: up to %.1f ms)",
                port.c_str(), round_trip_s * 1e3, check.expected_s * 1e3);
  check.sentence = text;
  if (!check.slow) return check;
  switch (low_latency) {
    case LowLatency::pseudo_terminal:
      check.sentence +=
          "; the simulator at the other end runs late: end other programs on this machine";
      break;
    case LowLatency::set:
      check.sentence +=
          "; the adapter is slow although its driver accepted ASYNC_LOW_LATENCY: connect the "
          "adapter without a hub, or use another adapter";
      break;
    case LowLatency::bus:
      check.sentence += "; the bus or its bridge adds the rest: raise the bit rate of the bus";
      break;
    case LowLatency::network:
      check.sentence += "; the network adds the rest: connect both machines by cable";
      break;
    case LowLatency::refused:
      check.sentence +=
          "; the adapter delays received bytes: install 70-kaz.rules (share/kaz/udev) in "
          "/etc/udev/rules.d and plug the adapter in again";
      break;
  }
  return check;
}

Result<RoundTripCheck> measure_round_trip(Robot& robot, const PortLink& port) {
  std::vector<double> trips;
  for (int i = 0; i < kHeartbeats; ++i) {
    KAZ_TRY(robot.heartbeat());
    trips.push_back(robot.statistics().round_trip.last_s);
  }
  std::nth_element(trips.begin(), trips.begin() + kHeartbeats / 2, trips.end());
  return judge_round_trip(port.name(), trips[kHeartbeats / 2], port.byte_time(),
                          port.low_latency());
}

}  // namespace kaz::host
