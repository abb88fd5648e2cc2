// The common interface: a robot to which behaviours talk. The same whether the board at the other end of
// the link is real or emulated.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/robot/link.h"
#include "shared/board/board.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

// Joint numbers, names and limits (rad), from shared/board/joints.def and the URDF.
struct JointInfo {
  const char* name;
  double lower_rad, upper_rad;
};
std::span<const JointInfo, KZ_JOINTS> joint_table();
std::optional<int> joint_index(std::string_view name);
enum Joint : int {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) name = index,
#include "shared/board/joints.def"
#undef KZ_JOINT
};

using JointAngles = std::array<double, KZ_JOINTS>;  // rad

struct Posture {
  Time time{};              // host time at which the board measured it
  std::uint32_t tick = 0;   // board time, ms
  JointAngles angle{};      // rad, as measured by the potentiometers
  std::uint16_t status = 0;  // KZ_STATUS_*
  double supply_volts = 0;
};

struct JointTarget {
  int joint;
  double angle_rad;
};

struct Gains {
  double kp_per_rad = 20;   // duty per rad
  double kd_s_per_rad = 0.15;
  double ramp_rad_per_s = 6;
};

struct LinkStatistics {
  std::uint64_t requests = 0, replies = 0, timeouts = 0, retries = 0, refused = 0, bad_frames = 0;
  std::uint64_t bytes_out = 0, bytes_in = 0;
  double round_trip_s = 0;  // smoothed
};

class Robot {
 public:
  // Identifies the board; fails with one sentence if nothing, or something that is no Kaz board, answers,
  // or if its protocol version is another.
  static Result<Robot> connect(Link& link, Clock& clock);

  const kz_identify_reply& identity() const;
  Clock& clock();

  Result<void> enable(std::uint32_t mask);
  Result<void> set_gains(std::uint32_t mask, const Gains& gains);
  // Fails with KZ_REFUSED_* named if a target is outside the limits or its joint is off.
  Result<void> set_targets(std::span<const JointTarget> targets, Time duration);
  // Asks the board. Also enters the answer into the history.
  Result<Posture> state();
  Result<kz_heartbeat_reply> heartbeat();

  // Measured posture at an earlier moment, interpolated between the two nearest states; nothing if the
  // moment lies outside what is remembered (the last 5 s) or more than 100 ms from any state.
  std::optional<Posture> posture_at(Time t) const;
  const LinkStatistics& statistics() const;

  // Best effort, for the end of every program: all motors off.
  void disable_all() noexcept;
};

}  // namespace kaz::host
