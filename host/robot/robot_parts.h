// Inside of Robot: one board, what was set on it, and how it is found again.
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

// A number for the wire, or nothing if it does not fit into the field.
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

// Fails (usage) if the mask has no joint, or one that does not exist.
Result<void> check_mask(std::uint32_t mask);
Result<void> check_joint(int joint);

// What to do with a request during which the link was lost and found again.
enum class AfterLoss { repeat, report };

struct Robot::Parts {
  Parts(std::span<const RobotBoard> boards, Clock& on_clock, const ConnectOptions& options);

  // Sends requests and returns their replies; observes the replies and reconnects if the link is lost
  // (`resumed` is then set).
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

  // Tick and status of a reply: is this still the board as we left it?
  void observe(std::uint8_t request, const Reply& reply);
  Result<Posture> take_state(const Reply& reply);
  // The state, with inertial data if queried (`motion` not null).
  Result<Posture> take_sensed(const Reply& state, const Reply* motion);
  // The replies of a cycle; `move` is null if no targets were sent.
  std::string describe_fault(std::uint16_t status);
  // "pan, lift", by ConnectOptions::joint_names.
  std::string names_of(std::uint32_t mask) const;
  // "still on: pan, lift" of a reply that was to confirm that motors are off; empty: it does.
  std::string still_on(std::uint32_t mask, std::uint16_t status) const;
  Result<Posture> take_cycle(const Reply* move, const Reply& state,
                             std::span<const JointTarget> targets, const Reply* motion = nullptr);
  void take_telemetry(std::uint8_t type, std::span<const std::uint8_t> fields, Time now);

  // Called when `requester` has failed with `error` (null: it has not, but `link_fault` was observed).
  // Success: the board is there again, motors as they were.
  Result<void> resume(const Error* error);
  Result<void> restore();
  Result<void> set_up();  // watchdog, gains, limits
  Result<void> switch_on(std::uint32_t mask);
  // A final link error: appends the recent frames as ConnectOptions::frames_path requests.
  Error for_good(Error error);
  Error not_done(std::span<const Request> requests) const;
  // `error` of a refused `enable` or `clear`: names the joints whose potentiometers are at fault.
  Error with_joints(Error error, const Reply& reply);
  // `error` of refused targets: with the limits that are in force, which the board is asked for.
  Error with_limits(Error error, const Reply& reply, std::span<const JointTarget> targets);
  // Often enough for the watchdog that is in force, ours or the board's own.
  Time heartbeat_period() const;
  Result<void> keep_content(Time until);

  // Sends heartbeats while it sleeps.
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

  // Settings sent to the board, to be restored after a reconnection.
  std::uint32_t on = 0;
  bool telemetry_on = false;
  bool inertial = false;  // queried with the state
  u8 watchdog_10ms = 0, reaction = 0;
  std::array<std::optional<kz_gains>, KZ_JOINTS> gains;
  std::array<std::optional<kz_limits>, KZ_JOINTS> limits;
  kz_telemetry telemetry_request{};

  std::optional<std::uint32_t> last_tick;
  std::optional<Resumption::Cause> link_fault;  // detected in a reply
  bool resumed = false;                         // in the latest exchange()
  std::string frames_at_loss;
  std::deque<Resumption> resumptions;

  struct Cycle {
    std::optional<Exchanger::Ticket> move, state;
    std::optional<Reply> move_reply, state_reply;
    std::vector<JointTarget> targets;
  };
  std::deque<Cycle> cycles;
  bool found_again = false;  // in send_cycle; reported by receive_cycle
  std::deque<TelemetryFrame> telemetry;
};

}  // namespace kaz::host
