// Robot: the host's client of a servo board, and the interface for behaviors.
// SPDX-License-Identifier: Apache-2.0
//
// Real and emulated boards have the same interface (paper, section 3). A call that queries the board blocks
// until the reply arrives. An error is one sentence: the board stopped replying, the link is lost, the
// program was interrupted, or the board refused the request (with joint and reason). Arguments out of range
// are usage errors. Not thread-safe.
//
// Link watchdog: if motors are on and no request arrives for ConnectOptions::watchdog, the board stops moving
// (ConnectOptions::reaction). Every request restarts the watchdog. Use clock() for waits, because that clock
// sends heartbeats during a wait.
//
// Reconnection starts if the port disappears, no reply comes, the board was reset, or the board's watchdog
// expired. The call that detects the loss searches for the board for up to ConnectOptions::reconnect. The
// call then restores watchdog, gains and limits, and enables the joints that were on. Enabling sets the
// present angle as target, so the robot does not move; motions in progress are discarded. The result of the
// interrupted call depends on the function:
// - exchange() and receive_cycle() return the present posture. The targets are not sent again.
// - set_targets, set_calibration, store_calibration, raw_drive, reset, start_loader and set_address fail with
//   an explanation. The robot remains usable.
// - All other calls are repeated once. Only take_resumption() reports the reconnection.
//
// If a shutdown by another cause than the link watchdog is latched, no joint is enabled, and the call fails.
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
  // Identifies the board. Fails if no Kaz board answers; the message then lists boards found at other
  // addresses. Also fails if the protocol version of the board is not supported. `link` and `clock` must
  // outlive the robot.
  static Result<Robot> connect(Link& link, Clock& clock, const ConnectOptions& options = {});
  // Connects to several boards that drive one robot (board_group.h). Ignores ConnectOptions::address. Also
  // returns the errors of check_boards.
  static Result<Robot> connect(std::span<const RobotBoard> boards, Clock& clock,
                               const ConnectOptions& options = {});
  Robot(Robot&&) noexcept;
  Robot& operator=(Robot&&) noexcept;
  ~Robot();  // does not switch motors off; see disable_all

  const kz_identify_reply& identity() const;
  // The clock that was passed to connect(), with one addition: while motors are on, sleep_until() sends
  // heartbeats for the link watchdog.
  Clock& clock();

  // ---- Motion

  // Switches motors on for the joints of the mask (bit n: joint n), and off for all other joints. A joint
  // that was off holds its present angle. Clears a latched shutdown whose cause is gone. Fails unless the
  // reply confirms the state of each joint.
  Result<void> enable(std::uint32_t mask);
  // Starts linear ramps to the targets within `duration` (0..65 s; 0: as fast as the joint's ramp limit
  // allows). If one target is outside its limits or its joint is off, the board refuses all targets.
  Result<void> set_targets(std::span<const JointTarget> targets, Time duration);
  // Returns the target angles (rad) of the joints of the mask, or the present angle of a joint that is off.
  // Returns 0 for all other joints.
  Result<JointAngles> read_targets(std::uint32_t mask = kAllJoints);
  // Reads the posture and adds it to the history.
  Result<Posture> state();
  // Sends set_targets() and state() together, so that a control cycle takes one round trip. At 115,200 baud
  // the round trip takes 9 ms for two joints and 12 ms for all joints. The posture is measured one or two
  // ticks after the board accepted the targets. Without targets, equivalent to state().
  Result<Posture> exchange(std::span<const JointTarget> targets, Time duration);
  // Both calls together replace exchange(), to control all 18 joints at 100 Hz: the next targets leave while
  // the last posture arrives. Postures come in the order of the cycles. receive_cycle() returns nullopt if
  // the next posture has not come by `deadline`, and fails if no sent cycle is pending.
  Result<void> send_cycle(std::span<const JointTarget> targets, Time duration);
  Result<std::optional<Posture>> receive_cycle(Time deadline);
  // Returns whether the board has the option `imu`. If the board has it, state() and exchange() from now on
  // also query the sensors and set Posture::inertial, which takes 2 ms more on the wire. send_cycle() never
  // queries the sensors.
  Result<bool> sense_inertial();
  // Returns angle, speed, duty, load and flags, ordered by joint number. For more than 9 joints, two requests
  // are needed. The data of the second request is some ticks newer.
  Result<std::vector<JointDetail>> joints(std::uint32_t mask);

  // ---- Safety

  // Switches all motors off at once, ahead of all queued requests. The shutdown stays latched until clear()
  // or enable(). Also fails if the reply reports motors still on, which can happen with a servo bus.
  Result<void> stop();
  // Clears a latched shutdown; motors stay off until enable(). Fails while the cause is present.
  Result<void> clear();
  // Sends a heartbeat, which restarts the link watchdog. Sets the watchdog's time limit to `watchdog`
  // (10 ms..1 s; zero: no change) and, if given, the watchdog's reaction.
  Result<kz_heartbeat_reply> heartbeat(Time watchdog = Time::zero(),
                                       std::optional<Reaction> reaction = std::nullopt);
  Result<Health> health();
  // Returns fault_sentence() for `status`, with the joint or voltage from a `health` query.
  std::string describe_fault(std::uint16_t status);
  // The board's counters since its reset.
  Result<kz_statistics_reply> board_statistics();
  Result<SelfTest> self_test();

  // ---- Settings, until the board's next reset

  Result<void> set_gains(std::uint32_t mask, const Gains& gains);
  Result<void> set_limits(std::uint32_t mask, const Limits& limits);
  Result<JointSettings> settings(int joint);

  // ---- Telemetry

  // Requests frames of the selection (KZ_TELEMETRY_*) every `period` (5 ms..65 s; zero: no more frames). Any
  // call that reads from the link also receives frames. The newest 256 frames are kept for next_telemetry().
  Result<void> subscribe(Time period, std::uint8_t selection);
  // Returns and removes the oldest frame; nullopt if no frame comes by `deadline`. Sends heartbeats during
  // the wait.
  Result<std::optional<TelemetryFrame>> next_telemetry(Time deadline);

  // ---- Calibration of the potentiometers; all motors must be off

  Result<Calibration> calibration();
  // Sets the calibration in RAM for the joints of the mask. `joints` is indexed by joint number.
  Result<void> set_calibration(std::uint32_t mask,
                               const std::array<JointCalibration, KZ_JOINTS>& joints);
  // Writes the calibration in use to flash; takes up to 3 s.
  Result<StoredCalibration> store_calibration();

  // ---- Bench; all motors must be off

  // Allows bench requests for 1..60 s; zero locks them again.
  Result<void> unlock(int seconds);
  // Drives one motor open loop at a duty of -1..1 for 1 ms..2 s. Needs unlock(). Returns the board's tick
  // after which the motor starts.
  Result<std::uint32_t> raw_drive(int joint, double duty, Time duration);
  // Resets the board and waits until the board answers. Gains and limits return to their defaults. The link
  // watchdog keeps the settings made through this object.
  Result<void> reset();
  // Starts the board's loader; the board does not answer for 3 s.
  Result<void> start_loader();
  // Writes the board's address (1..14) to flash; effective after the board's next reset. Needs unlock().
  Result<void> set_address(int address, bool shared_line);

  // ---- The link

  // Returns and removes the oldest reconnection that was not returned yet; nullopt if there is no such
  // reconnection.
  std::optional<Resumption> take_resumption();
  // Measured posture at time `t`, interpolated between the two nearest states. Returns nullopt if `t` is
  // outside the history (the last 5 s) or more than 100 ms from any state.
  std::optional<Posture> posture_at(Time t) const;
  // Host time of the newest posture in the history.
  std::optional<Time> newest_posture() const;
  // Bound on the error of Posture::time (clock_relation.h).
  Time clock_error() const;

  const LinkStatistics& statistics() const;
  // The last 64 frames, one line each, to print when the link fails (frame_log.h).
  std::string recent_frames() const;

  // Switches all motors off, with retries. Call this at the end of every program, even an interrupted one.
  // Fails (environment) unless the board's reply confirms that all motors are off; the message names joints
  // that are still on. After a failure, the motors may have power.
  [[nodiscard]] Result<void> disable_all() noexcept;

 private:
  struct Parts;
  explicit Robot(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

// Mask of the shutdown reason in a status word.
inline constexpr std::uint16_t kMotorsOffFaults = 0xFF00;

// Classifies a shutdown. Returns Fault::environment if `status` reports an expired link watchdog, or no
// latched shutdown. Else returns Fault::failed.
Fault shutdown_fault(std::uint16_t status);

// Describes the faults latched in `status` and the remedy; nullopt without a fault. `where`: the location of
// the fault, such as a joint.
std::optional<std::string> fault_sentence(std::uint16_t status, const std::string& where = {});

}  // namespace kaz::host
