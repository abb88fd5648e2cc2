// Robot: the host's client of a servo board, and the interface for behaviors.
// SPDX-License-Identifier: Apache-2.0
//
// Real and emulated boards have the same interface (section 3 of the paper, see README.md). A call that
// queries the board blocks until the reply arrives. Every error message states the cause of the failure.
// Possible causes: the board stopped replying, the link is lost, the program was interrupted, or the
// board refused the request (with joint and reason). An argument out of range is a usage error. Not
// thread-safe.
//
// Link watchdog: if motors are on and no request arrives for ConnectOptions::watchdog, the board stops moving
// (ConnectOptions::reaction). Every request restarts the watchdog. Wait with clock().sleep_until(), which
// sends heartbeats during the wait.
//
// Reconnection starts if the port disappears, no reply comes, the board was reset, or the board's watchdog
// expired. The call that detects the loss searches for the board. The search lasts at most
// ConnectOptions::reconnect. Once the board is found, the call restores watchdog, gains and limits, and
// enables the joints that were on. The target of each enabled joint becomes the joint's present angle, so the
// robot does not move. Motions in progress are discarded. The result of the interrupted call depends on the
// function:
// - exchange() and receive_cycle() return the present posture. The targets are not sent again. send_cycle()
//   returns success, and the next receive_cycle() returns the present posture.
// - set_targets, set_calibration, store_calibration, raw_drive, reset, start_loader and set_address fail; the
//   error message explains that the link was lost. The robot remains usable.
// - disable_all() does not reconnect.
// - All functions outside this list repeat their requests once and return the result of the repetition. This
//   result does not show whether the link was reconnected. To detect a reconnection, call take_resumption().
//
// If the board has shut down for any reason other than its link watchdog, no joint is enabled, and the call
// fails.
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
  // Identifies the board. Fails if no Kaz board answers at the address; the error message lists boards that
  // answer at other addresses. Also fails if the protocol version of the board is not supported. `link` and
  // `clock` must outlive the robot.
  static Result<Robot> connect(Link& link, Clock& clock, const ConnectOptions& options = {});
  // Connects to several boards that drive one robot (board_group.h). Ignores ConnectOptions::address. Also
  // returns the errors of check_boards.
  static Result<Robot> connect(std::span<const RobotBoard> boards, Clock& clock,
                               const ConnectOptions& options = {});
  Robot(Robot&&) noexcept;
  Robot& operator=(Robot&&) noexcept;
  ~Robot();  // does not switch motors off; see disable_all

  const kz_identify_reply& identity() const;
  // Returns a wrapper of the clock that was passed to connect(). While motors are on, the function
  // sleep_until() of the wrapper also sends heartbeats. Each heartbeat restarts the link watchdog.
  Clock& clock();

  // ---- Motion

  // Switches motors on for the joints of the mask (bit n: joint n), and off for all other joints. A joint
  // that was off holds its present angle. Clears a latched shutdown if its cause is no longer present. Fails
  // if the board's reply does not confirm the requested state of each motor.
  Result<void> enable(std::uint32_t mask);
  // Starts linear ramps to the targets. A ramp takes `duration` (0..65 s), or longer if the joint's ramp
  // limit requires more time. If one target is outside the joint's limits, or if one of the joints is off,
  // the board refuses all targets.
  Result<void> set_targets(std::span<const JointTarget> targets, Time duration);
  // For each joint of the mask, returns the target angle (rad), or the present angle if the joint is off.
  // Returns 0 for all other joints.
  Result<JointAngles> read_targets(std::uint32_t mask = kAllJoints);
  // Reads the posture and adds it to the history.
  Result<Posture> state();
  // Sends the requests of set_targets() and state() together, so that a control cycle takes one round trip.
  // At 115,200 baud the round trip takes 9 ms for two joints and 12 ms for all joints. The posture is
  // measured one or two ticks after the board accepted the targets. If `targets` is empty, exchange() does
  // the same as state().
  Result<Posture> exchange(std::span<const JointTarget> targets, Time duration);
  // send_cycle() and receive_cycle() are the two halves of exchange(). With these functions, the host sends
  // the next targets while the previous posture arrives. So a program can control all 18 joints at 100 Hz.
  // Postures are returned in the order of the calls of send_cycle(). If the next posture does not arrive by
  // `deadline`, receive_cycle() returns nullopt. If no sent cycle is pending, receive_cycle() fails.
  Result<void> send_cycle(std::span<const JointTarget> targets, Time duration);
  Result<std::optional<Posture>> receive_cycle(Time deadline);
  // Returns whether the board has the option `imu`. If the board has this option, state() and exchange() from
  // now on also query the sensors and set Posture::inertial. The query adds 2 ms of transmission time to each
  // call. send_cycle() never queries the sensors.
  Result<bool> sense_inertial();
  // Returns angle, speed, duty, load and flags, ordered by joint number. More than 9 joints need two
  // requests; the data from the second request is a few ticks newer.
  Result<std::vector<JointDetail>> joints(std::uint32_t mask);

  // ---- Safety

  // Switches all motors off at once, ahead of all queued requests. The shutdown stays latched until clear()
  // or enable(). Also fails if the reply reports that motors are still on, as can happen with a servo bus.
  Result<void> stop();
  // Clears a latched shutdown; motors stay off until enable(). Fails as long as the cause of the shutdown is
  // present.
  Result<void> clear();
  // Sends a heartbeat, which restarts the link watchdog. `watchdog`: new time limit of the link watchdog, 10
  // ms to 1 s; zero: no change. `reaction`: new reaction of the link watchdog; nullopt: no change.
  Result<kz_heartbeat_reply> heartbeat(Time watchdog = Time::zero(),
                                       std::optional<Reaction> reaction = std::nullopt);
  Result<Health> health();
  // Queries the board's health and returns fault_sentence() for `status`. The sentence contains the joint
  // that caused the shutdown, or the supply voltage if the voltage caused the shutdown.
  std::string describe_fault(std::uint16_t status);
  // Returns the board's counters, which start at 0 after each reset of the board.
  Result<kz_statistics_reply> board_statistics();
  Result<SelfTest> self_test();

  // ---- Settings, which the board loses at its next reset

  Result<void> set_gains(std::uint32_t mask, const Gains& gains);
  Result<void> set_limits(std::uint32_t mask, const Limits& limits);
  Result<JointSettings> settings(int joint);

  // ---- Telemetry

  // Requests frames of the selection (KZ_TELEMETRY_*) every `period` (5 ms..65 s; zero stops the frames). Any
  // call that reads from the link also receives telemetry frames. The newest 256 frames are kept for
  // next_telemetry().
  Result<void> subscribe(Time period, std::uint8_t selection);
  // Returns and removes the oldest telemetry frame; nullopt if no frame comes by `deadline`. Sends heartbeats
  // during the wait.
  Result<std::optional<TelemetryFrame>> next_telemetry(Time deadline);

  // ---- Calibration of the potentiometers; all motors must be off

  Result<Calibration> calibration();
  // Sets the calibration in RAM for the joints of the mask. `joints` is indexed by joint number.
  Result<void> set_calibration(std::uint32_t mask,
                               const std::array<JointCalibration, KZ_JOINTS>& joints);
  // Writes the calibration in use to flash; takes up to 3 s.
  Result<StoredCalibration> store_calibration();

  // ---- Bench requests; all motors must be off

  // Permits bench requests for the next `seconds` (1..60). If `seconds` is 0, ends the permission.
  Result<void> unlock(int seconds);
  // Drives one motor open loop at a duty of -1..1 for 1 ms..2 s. Call unlock() before this function. Returns
  // the board's tick at the time of the request; the motor starts at the next tick.
  Result<std::uint32_t> raw_drive(int joint, double duty, Time duration);
  // Resets the board and waits until the board answers. Gains and limits return to their defaults. The link
  // watchdog keeps the time limit and the reaction that were set through this object.
  Result<void> reset();
  // Starts the board's loader; the board does not answer for 3 s.
  Result<void> start_loader();
  // Writes the board's address (1..14) to flash; the address takes effect at the board's next reset. Call
  // unlock() before this function.
  Result<void> set_address(int address, bool shared_line);

  // ---- The link

  // Each reconnection is appended to a queue. take_resumption() returns the oldest reconnection and removes
  // it from the queue. If the queue is empty, take_resumption() returns nullopt.
  std::optional<Resumption> take_resumption();
  // Measured posture at time `t`, interpolated between the two nearest states. Returns nullopt if `t` is
  // outside the history (the last 5 s) or more than 100 ms from any state.
  std::optional<Posture> posture_at(Time t) const;
  // Host time of the newest posture in the history.
  std::optional<Time> newest_posture() const;
  // Bound on the error of Posture::time (clock_relation.h).
  Time clock_error() const;

  const LinkStatistics& statistics() const;
  // Text with the last 64 frames, one per line. Print the text when the link fails (frame_log.h).
  std::string recent_frames() const;

  // Switches all motors off, with retries. Call disable_all() at the end of every program, even if the
  // program was interrupted. Fails (environment) if the board's reply does not confirm that all motors are
  // off. The error message names joints that are still on. After a failure of disable_all(), the motors may
  // still have power.
  [[nodiscard]] Result<void> disable_all() noexcept;

 private:
  struct Parts;
  explicit Robot(std::unique_ptr<Parts> parts);
  Result<void> lower_ramps();  // to ConnectOptions::max_rad_per_s
  std::unique_ptr<Parts> parts_;
};

// Mask of the shutdown reason in a status word.
inline constexpr std::uint16_t kMotorsOffFaults = 0xFF00;

// Classifies a shutdown. Returns Fault::environment if the link watchdog caused the shutdown, or if `status`
// contains no shutdown. Otherwise returns Fault::failed.
Fault shutdown_fault(std::uint16_t status);

// Describes the faults latched in `status` and the remedy; returns nullopt if no fault is latched. `where`:
// the location of the fault, such as a joint.
std::optional<std::string> fault_sentence(std::uint16_t status, const std::string& where = {});

}  // namespace kaz::host
