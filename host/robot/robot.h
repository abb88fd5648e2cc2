// Robot: the host's client of a servo board, the interface of behaviours.
// SPDX-License-Identifier: Apache-2.0
//
// The same for a real and an emulated board (paper, section 3). Calls that query the board block until its
// reply. Errors are one sentence each: the board stopped replying, the link is lost, the program was
// interrupted, or the board refused (the sentence contains joint and reason). Values out of range are usage
// errors. Not thread-safe.
//
// Link watchdog: the board stops moving (ConnectOptions::reaction) if it received nothing for
// ConnectOptions::watchdog while motors are on. Every request resets it. To wait, use clock(), which sends
// heartbeats meanwhile.
//
// Reconnection: when the port disappears, no reply comes, the board was reset, or its watchdog has expired,
// the call that detects it searches for the board for ConnectOptions::reconnect, restores watchdog, gains
// and limits, and enables the joints that were on. Enabling makes the present angle the target, so nothing
// moves; motions in progress are discarded. Then
//   - queries, enable, set_gains and set_limits are repeated: the caller sees it by take_resumption() only;
//   - exchange() and receive_cycle() return the present posture; no target was sent;
//   - all others fail with a sentence that explains it; the robot remains usable.
// If a shutdown for another reason is latched, nothing is enabled: that is an error.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "host/link/link_statistics.h"
#include "host/robot/posture.h"
#include "host/robot/robot_types.h"
#include "shared/board/board.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

class Robot {
 public:
  // Identifies the board; fails with one sentence if nothing, or something that is no Kaz board,
  // answers (boards at other addresses are named), or if its protocol version is another.
  // `link` and `clock` must outlive the robot.
  static Result<Robot> connect(Link& link, Clock& clock, const ConnectOptions& options = {});
  // Several boards that drive one robot (board_group.h); ConnectOptions::address is not used. Errors also:
  // those of check_boards.
  static Result<Robot> connect(std::span<const RobotBoard> boards, Clock& clock,
                               const ConnectOptions& options = {});
  Robot(Robot&&) noexcept;
  Robot& operator=(Robot&&) noexcept;
  ~Robot();  // leaves the motors as they are; see disable_all

  const kz_identify_reply& identity() const;
  // That of connect(); sleeping on it keeps the link watchdog content while motors are on.
  Clock& clock();

  // ---- Motion

  // Motors on for the joints of the mask (bit n: joint n), off for all others. A joint that was off
  // holds the angle it has. Clears a latched shutdown whose cause is gone. Fails unless the reply says so of
  // each joint.
  Result<void> enable(std::uint32_t mask);
  // Straight ramps to the targets in `duration` (0..65 s; 0: as fast as the joint's ramp allows).
  // All or none: refused if a target is outside its limits or its joint is off.
  Result<void> set_targets(std::span<const JointTarget> targets, Time duration);
  // Where the joints of the mask are going; for a joint that is off, its angle. Others: 0.
  Result<JointAngles> read_targets(std::uint32_t mask = kAllJoints);
  // Also enters the answer into the history.
  Result<Posture> state();
  // state() and set_targets() in one go: both requests leave together, so that a control cycle
  // costs one round trip: 9 ms for two joints at 115,200 baud, 12 ms for all. The posture is that
  // of a tick or two after the targets were taken.
  Result<Posture> exchange(std::span<const JointTarget> targets, Time duration);
  // The same in two steps, for all 18 joints at 100 Hz: the next targets leave while the last
  // posture comes. Postures come in the order of the cycles; nothing if the next has not come until
  // `deadline`. Fails if a cycle is received that was not sent.
  Result<void> send_cycle(std::span<const JointTarget> targets, Time duration);
  Result<std::optional<Posture>> receive_cycle(Time deadline);
  // True if the board has the option `imu`; then state() and exchange() also query it from now on and fill in
  // Posture::inertial: 2 ms more on the wire. send_cycle() does not.
  Result<bool> sense_inertial();
  // Angle, speed, duty, load and flags, in the order of the joints. More than 9 joints are two
  // requests, of which the second is some ticks younger.
  Result<std::vector<JointDetail>> joints(std::uint32_t mask);

  // ---- Safety

  // All motors off at once, ahead of everything that waits; latched until clear() or enable(). Fails also
  // where the board's reply says that motors are still on, as a bus of servos can.
  Result<void> stop();
  // Forgets a latched shutdown; motors stay off until enable(). Fails while its cause is present.
  Result<void> clear();
  // watchdog: new limit of the board's link watchdog, 10 ms..1 s; zero leaves it as it is.
  Result<kz_heartbeat_reply> heartbeat(Time watchdog = Time::zero(),
                                       std::optional<Reaction> reaction = std::nullopt);
  Result<Health> health();
  // fault_sentence of a status with a fault, with the joint or the voltage read by `health`.
  std::string describe_fault(std::uint16_t status);
  // The board's counts since its reset.
  Result<kz_statistics_reply> board_statistics();
  Result<SelfTest> self_test();

  // ---- Settings, until the board's next reset

  Result<void> set_gains(std::uint32_t mask, const Gains& gains);
  Result<void> set_limits(std::uint32_t mask, const Limits& limits);
  Result<JointSettings> settings(int joint);

  // ---- Telemetry

  // Frames of the selection (KZ_TELEMETRY_*) every `period` (5 ms..65 s; zero: none). They come
  // while any call reads, and are kept, the newest 256, until they are taken.
  Result<void> subscribe(Time period, std::uint8_t selection);
  // The oldest frame that was not taken yet; nothing if none comes until `deadline`.
  Result<std::optional<TelemetryFrame>> next_telemetry(Time deadline);

  // ---- Calibration of the potentiometers; all motors must be off

  Result<Calibration> calibration();
  // In RAM; for the joints of the mask, from `joints` by joint number.
  Result<void> set_calibration(std::uint32_t mask,
                               const std::array<JointCalibration, KZ_JOINTS>& joints);
  // Writes what is in use to flash; takes up to 3 s.
  Result<StoredCalibration> store_calibration();

  // ---- Bench; all motors must be off

  // Allows what only a bench needs, for 1..60 s; zero locks again.
  Result<void> unlock(int seconds);
  // Drives one motor at a duty of -1..1 without its loop for 1 ms..2 s. Needs unlock(). Returns the
  // board's tick, after which it begins.
  Result<std::uint32_t> raw_drive(int joint, double duty, Time duration);
  // Starts the board anew and waits until it answers; gains and limits are those after a reset.
  Result<void> reset();
  // The board leaves for its loader, and does not answer for 3 s.
  Result<void> start_loader();
  // Writes the board's address (1..14) to flash, in force after its next reset. Needs unlock().
  Result<void> set_address(int address, bool shared_line);

  // ---- The link

  // Returns each reconnection since connect() once, oldest first.
  std::optional<Resumption> take_resumption();
  // Measured posture at an earlier time, interpolated between the two nearest states; nothing if the time is
  // outside the history (the last 5 s) or more than 100 ms from any state.
  std::optional<Posture> posture_at(Time t) const;
  // Host time of the newest posture in the history.
  std::optional<Time> newest_posture() const;
  // Bound on the error of Posture::time (clock_relation.h).
  Time clock_error() const;

  const LinkStatistics& statistics() const;
  // The last 64 frames, one line each: to be shown when the link fails (frame_log.h).
  std::string recent_frames() const;

  // Best effort, for the end of every program, interrupted or not: all motors off. Fails (environment)
  // unless the board's reply confirms it, with the joints that are still on; the motors may then have
  // power.
  [[nodiscard]] Result<void> disable_all() noexcept;

 private:
  struct Parts;
  explicit Robot(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

// The reason of a shutdown in a status word.
inline constexpr std::uint16_t kMotorsOffFaults = 0xFF00;

// Whose fault it is that the board has switched its motors off: the environment's if nothing reached the
// board for its watchdog's time, or no shutdown is in `status`; else the robot's (Fault::failed).
Fault shutdown_fault(std::uint16_t status);

// Nothing if no fault is latched in `status`; else a sentence that names them, `where` they are, and
// what to do.
std::optional<std::string> fault_sentence(std::uint16_t status, const std::string& where = {});

}  // namespace kaz::host
