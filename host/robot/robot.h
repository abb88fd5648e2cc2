// The common interface: a robot to which behaviours talk.
// SPDX-License-Identifier: Apache-2.0
//
// The same whether the board at the other end of the link is real or emulated (paper, section 3).
// Every call that asks the board waits for its answer, up to ConnectOptions::timeout for each of
// its tries. Errors are one sentence each: the board stopped answering, the link is gone, the
// program was interrupted, or the board refused (then the sentence names the joint and the reason).
// One thread at a time.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "host/robot/link.h"
#include "host/robot/link_statistics.h"
#include "host/robot/posture.h"
#include "shared/board/board.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

struct JointTarget {
  int joint;
  double angle_rad;
};

struct Gains {
  double kp_per_rad = 20;      // duty per rad
  double kd_s_per_rad = 0.15;  // duty per rad/s
  double ramp_rad_per_s = 6;   // highest speed of the commanded angle
};

struct ConnectOptions {
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  Time timeout = std::chrono::milliseconds(50);  // of one try
  int retries = 5;                               // tries after the first
};

class Robot {
 public:
  // Identifies the board; fails with one sentence if nothing, or something that is no Kaz board,
  // answers, or if its protocol version is another. `link` and `clock` must outlive the robot.
  static Result<Robot> connect(Link& link, Clock& clock, const ConnectOptions& options = {});
  Robot(Robot&&) noexcept;
  Robot& operator=(Robot&&) noexcept;
  ~Robot();  // leaves the motors as they are; see disable_all

  const kz_identify_reply& identity() const;
  Clock& clock();

  // Motors on for the joints of the mask (bit n: joint n), off for all others. A joint that was off
  // holds the angle it has. Clears latched faults whose cause is gone.
  Result<void> enable(std::uint32_t mask);
  Result<void> set_gains(std::uint32_t mask, const Gains& gains);
  // Straight ramps to the targets in `duration` (0..65 s; 0: as fast as the joint's ramp allows).
  // All or none: refused if a target is outside its limits or its joint is off.
  Result<void> set_targets(std::span<const JointTarget> targets, Time duration);
  // Asks the board. Also enters the answer into the history.
  Result<Posture> state();
  // state() and set_targets() in one go: both requests leave together, so that a control cycle
  // costs one round trip: 9 ms for two joints at 115,200 baud, 12 ms for all. The posture is that
  // of a tick or two after the targets were taken.
  Result<Posture> exchange(std::span<const JointTarget> targets, Time duration);
  // watchdog: new limit of the board's link watchdog, 10 ms..1 s; zero leaves it as it is.
  Result<kz_heartbeat_reply> heartbeat(Time watchdog = Time::zero());
  // The board's counts since its reset.
  Result<kz_statistics_reply> board_statistics();

  // Measured posture at an earlier moment, interpolated between the two nearest states; nothing if
  // the moment lies outside what is remembered (the last 5 s) or more than 100 ms from any state.
  std::optional<Posture> posture_at(Time t) const;
  // Host time of the newest remembered posture.
  std::optional<Time> newest_posture() const;
  // Bound on the error of Posture::time (clock_relation.h).
  Time clock_error() const;

  const LinkStatistics& statistics() const;
  // The last 64 frames, one line each: to be shown when the link fails (frame_log.h).
  std::string recent_frames() const;

  // Best effort, for the end of every program, interrupted or not: all motors off.
  void disable_all() noexcept;

 private:
  struct Parts;
  explicit Robot(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

// Faults after which the motors are off until they are enabled again.
inline constexpr std::uint16_t kMotorsOffFaults = 0xFF00;

// Nothing if no fault is latched in `status`; else a sentence that names them and what to do.
std::optional<std::string> fault_sentence(std::uint16_t status);

}  // namespace kaz::host
