// Load test of the wire: sends all 18 targets and receives all 18 positions, cycle after cycle.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/robot/robot.h"

namespace kaz::lockstep {

struct WireLoad {
  double rate_hz = 0;                  // rate of received postures
  double share_out = 0, share_in = 0;  // utilization of the wire in each direction, 0..1
  // Largest delay of a cycle: the time from sending the cycle's targets to receiving the cycle's posture.
  double oldest_s = 0;
  // Number of cycles that started late. The cause of a late start is that too many earlier cycles are
  // unanswered.
  std::uint64_t late = 0;
  std::uint64_t retries = 0;
};

// Switches all joints on and swings each joint by 0.05 rad about the joint's present angle. `byte_time`: time
// of one byte on the wire. `rate_hz`: cycles per second; if the value is 0, the next targets are sent as soon
// as the window of unanswered requests has room.
Result<WireLoad> run_wire_load(host::Robot& robot, Time byte_time, double rate_hz, Time duration);

}  // namespace kaz::lockstep
