// Several boards as one: each request goes to the boards that it concerns, their replies become one.
// SPDX-License-Identifier: Apache-2.0
//
// - Requests with a mask of joints are split by it; the others go to all boards. A board that a request does
//   not concern gets a heartbeat with it, so that every request restarts every link watchdog.
// - Board time is that of the first board, the reference; ticks of the others are related to it by the host's
//   clock (clock_relation.h).
// - A `state_reply` has the angles of all joints at the tick of the reference. The other boards' angles are
//   interpolated between their last two states, or carried on by their speed for at most kMaxAhead, to that
//   time. Its error is that of both clock relations, some 0.1 ms to 1 ms, times the speed of the joint.
// - A flag of the status is set if it is of any board; ENABLED if all boards that were to switch motors
//   on have them on. A shutdown of one board, but of its link watchdog, switches the motors of the others
//   off.
// - What one board refuses is refused; what another has done meanwhile stays done, but motors that were
//   switched on by an `enable` are switched off again.
//
// Not of a group: telemetry and the setting of addresses, which are refused with a sentence.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/link/clock_relation.h"
#include "host/link/requester.h"
#include "host/robot/posture.h"
#include "host/robot/robot_types.h"

namespace kaz::host {

class BoardGroup final : public Exchanger {
 public:
  static constexpr Time kMaxAhead = std::chrono::milliseconds(10);
  static constexpr Time kMaxBetween = std::chrono::milliseconds(100);

  // At least one board; each joint on exactly one (check_boards). `clock` and all links must outlive it.
  BoardGroup(std::vector<RobotBoard> boards, Clock& clock, int retries);
  ~BoardGroup() override;

  Result<std::vector<Reply>> exchange(std::span<const Request> requests) override;
  Result<Ticket> post(const Request& request) override;
  Result<std::optional<Reply>> collect(Ticket ticket, Time deadline) override;
  Result<Reply> exchange_at_once(const Request& request) override;
  Result<void> send(const Request& request) override;
  Result<bool> listen(Time deadline) override;
  void on_telemetry(Telemetry) override {}
  void start_anew() override;
  void limit_tries(std::optional<int> tries) override;
  const LinkStatistics& statistics() const override;
  std::string recent_frames() const override;
  // Only its name and reopen(), which opens again what has failed, are of use.
  Link& link() override;
  std::string failed_name() override;
  std::span<const std::uint8_t> noise() const override;
  bool timed_out() const override;
  bool heard_echo() const override;
  Time last_sent() const override;
  bool take_restart() override;

 private:
  struct Member;
  struct Exchange;
  class Links;

  std::optional<Request> part_of(const Request& request, const Member& member) const;
  Error blame(std::size_t index, Error error);
  Reply merge(const Exchange& exchange);
  void merge_fields(const Exchange& exchange, Reply& merged);
  void merge_state(const Exchange& exchange, Reply& merged);
  void merge_calibration(const Exchange& exchange, Reply& merged);
  std::uint16_t merge_status();
  void switch_off();
  static void switch_off(Member& member);
  void note_enabled(const Request& request);

  std::vector<std::unique_ptr<Member>> members_;
  std::unique_ptr<Links> links_;
  std::map<Ticket, std::unique_ptr<Exchange>> open_;
  Ticket next_ticket_ = 1;
  std::size_t failed_ = 0;  // the member that failed last
  mutable LinkStatistics statistics_;
};

}  // namespace kaz::host
