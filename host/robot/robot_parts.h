// Internals of Robot: the board, the settings sent to the board, and reconnection.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/link/clock_relation.h"
#include "host/link/exchanger.h"
#include "host/robot/posture_history.h"
#include "host/robot/robot.h"
#include "host/robot/typed_request.h"

namespace kaz::host {

// Converts a number for the wire; nullopt if the number does not fit the field.
template <class Number>
std::optional<Number> to_wire(double value) {
  const double rounded = std::round(value);
  if (!(rounded >= std::numeric_limits<Number>::min() &&
        rounded <= std::numeric_limits<Number>::max())) {
    return std::nullopt;
  }
  return static_cast<Number>(rounded);
}

inline double angle_of(s16 wire) {
  return static_cast<double>(wire) / KZ_ANGLE_PER_RAD;
}

// Fails (usage) if the mask is empty or contains a joint that does not exist.
Result<void> check_mask(std::uint32_t mask);
Result<void> check_joint(int joint);

// Reaction of a call to a link that was lost and restored during a request: repeat the request, or report an
// error.
enum class AfterLoss { repeat, report };

struct Robot::Parts {
  Parts(std::span<const RobotBoard> boards, Clock& on_clock, const ConnectOptions& options);

  // Sends requests and returns their replies. Calls observe() for each reply. If the link is lost, reconnects
  // and sets `resumed`.
  Result<std::vector<Reply>> exchange(std::span<const Request> requests, AfterLoss after_loss);
  template <class Message, class Answer>
  Result<Answer> query(std::uint8_t type, const Message& message, u8 (*pack)(const Message*, u8*),
                       u8 (*unpack)(Answer*, const u8*, u8),
                       AfterLoss after_loss = AfterLoss::repeat) {
    const Request request = make_request(type, message, pack);
    const auto replies = exchange({&request, 1}, after_loss);
    if (!replies) return tl::unexpected(replies.error());
    return read_reply(replies->front(), unpack);
  }

  // Checks tick and status of a reply: detects a reset, an expired watchdog or a shutdown.
  void observe(std::uint8_t request, const Reply& reply);
  // Converts a `state_reply` and adds it to the history.
  Result<Posture> take_state(const Reply& reply);
  // Converts a state and the inertial reply; `motion` is null if the inertial sensors were not queried.
  Result<Posture> take_sensed(const Reply& state, const Reply* motion);
  std::string describe_fault(std::uint16_t status);
  // Largest ramp within ConnectOptions::max_rad_per_s, rad/s; a multiple of the board's unit, 0.1 to 12.
  double max_ramp(std::size_t joint) const;
  // Returns joint names from ConnectOptions::joint_names, such as "pan, lift".
  std::string names_of(std::uint32_t mask) const;
  // Checks a reply that must confirm that motors are off. Returns a text such as "still on: pan, lift"; empty
  // if the reply confirms that all motors are off.
  std::string still_on(std::uint32_t mask, std::uint16_t status) const;
  // Evaluates the replies of a cycle. `move` is null if no targets were sent.
  Result<Posture> take_cycle(const Reply* move, const Reply& state,
                             std::span<const JointTarget> targets, const Reply* motion = nullptr);
  void take_telemetry(std::uint8_t type, std::span<const std::uint8_t> fields, Time now);

  // Reconnects. `error` is the error of `requester`, or null if only `link_fault` was detected. After
  // success, the board answers, and the motors that were on before the loss are on again.
  Result<void> resume(const Error* error);
  Result<void> restore();
  Result<void> set_up();  // sends watchdog, gains and limits
  Result<void> switch_on(std::uint32_t mask);
  // Handles a permanent link failure: writes the recent frames to ConnectOptions::frames_path and adds the
  // file's name to the error.
  Error for_good(Error error);
  Error not_done(std::span<const Request> requests) const;
  // Adds the joints with faulty potentiometers to the error of a refused `enable` or `clear`.
  Error with_joints(Error error, const Reply& reply);
  // Queries the limits in force on the board and adds them to the error of refused targets.
  Error with_limits(Error error, const Reply& reply, std::span<const JointTarget> targets);
  // Returns a heartbeat period that is short enough for the watchdog. The watchdog's time limit was set by
  // this object, or is the board's default.
  Time heartbeat_period() const;
  // Sleeps until `until` and sends heartbeats while motors or telemetry are on.
  Result<void> keep_content(Time until);

  // Sends heartbeats during sleep_until().
  class KeepingClock final : public Clock {
   public:
    explicit KeepingClock(Parts& parts) : parts_(parts) {}
    Time now() const override { return parts_.clock.now(); }
    Result<void> sleep_until(Time t) override;

   private:
    Parts& parts_;
  };

  ConnectOptions options;
  Clock& clock;
  KeepingClock keeping_clock;
  std::unique_ptr<Exchanger> owned_requester;
  Exchanger& requester;
  ClockRelation relation;
  PostureHistory history;
  kz_identify_reply identity{};

  // Settings that were sent to the board and are restored after a reconnection.
  std::uint32_t on = 0;
  bool telemetry_on = false;
  bool inertial = false;  // true: each state() also queries the inertial sensors
  u8 watchdog_10ms = 0, reaction = 0;
  std::array<std::optional<kz_gains>, KZ_JOINTS> gains;
  std::array<std::optional<kz_limits>, KZ_JOINTS> limits;
  kz_telemetry telemetry_request{};

  std::optional<std::uint32_t> last_tick;
  // Cause of a lost link, if a reply has shown the loss.
  std::optional<Resumption::Cause> link_fault;
  bool resumed = false;  // true: the latest exchange() has reconnected
  std::string frames_at_loss;
  std::deque<Resumption> resumptions;

  struct Cycle {
    std::optional<Exchanger::Ticket> move, state;
    std::optional<Reply> move_reply, state_reply;
    std::vector<JointTarget> targets;
  };
  std::deque<Cycle> cycles;
  // True: send_cycle() has reconnected, and receive_cycle() must report the reconnection.
  bool found_again = false;
  std::deque<TelemetryFrame> telemetry;
};

}  // namespace kaz::host
