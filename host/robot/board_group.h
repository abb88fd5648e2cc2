// A group of boards that acts as one: distributes each request and merges the replies.
// SPDX-License-Identifier: Apache-2.0
//
// - A request with a joint mask is split by board; any other request goes to every board. If a request has no
//   part for a board, this board gets a heartbeat instead. So each request restarts the link watchdogs of all
//   boards.
// - Board time is the time of the first board, the reference. The ticks of other boards are converted to the
//   reference's ticks through host time (clock_relation.h).
// - A `state_reply` contains the angles of all joints at the reference's tick. Angles of other boards are
//   interpolated between the last two states, or extrapolated by at most kMaxAhead. The error of these angles
//   is the joint's speed times a time error of 0.1 ms to 1 ms. The time error has two causes: the error of
//   the reference's clock relation, and the error of the other board's clock relation.
// - The group sets a status flag if any board sets this flag, with two exceptions. The group sets ENABLED
//   only if ENABLED is set on each board whose motors should be on. The group sets UNLOCKED only if UNLOCKED
//   is set on each board.
// - If one board shuts down, the motors of all boards are switched off, unless the board's link watchdog
//   caused the shutdown.
// - If one board refuses a request, the group reports the request as refused, even if other boards have
//   executed the request. After a refused `enable`, the motors of all boards are switched off.
//
// Requests for telemetry and `set_address` requests need a single board, so the group rejects these requests
// with a usage error.
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
  // Maximum time by which angles are extrapolated.
  static constexpr Time kMaxAhead = std::chrono::milliseconds(10);
  // Maximum time between two states for an interpolation of angles. If the last two states are further apart
  // than kMaxBetween, the group uses the angle of the latest state, without interpolation.
  static constexpr Time kMaxBetween = std::chrono::milliseconds(100);

  // Requires at least one board, and each joint on exactly one board (check_boards). `clock` and all links
  // must outlive the group.
  BoardGroup(std::vector<RobotBoard> boards, Clock& clock, int retries);
  ~BoardGroup() override;

  Result<std::vector<Reply>> exchange(std::span<const Request> requests) override;
  Result<Ticket> post(const Request& request) override;
  Result<std::optional<Reply>> collect(Ticket ticket, Time deadline) override;
  Result<Reply> exchange_at_once(const Request& request) override;
  Result<void> send(const Request& request) override;
  // Reads from the link of the first board only. The group rejects requests for telemetry, so no board sends
  // telemetry frames.
  Result<bool> listen(Time deadline) override;
  void on_telemetry(Telemetry) override {}
  void start_anew() override;
  void limit_tries(std::optional<int> tries) override;
  const LinkStatistics& statistics() const override;
  std::string recent_frames() const override;
  // Returns a link that supports only name() and reopen(). On this link, reopen() reopens the lost links of
  // all boards.
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
  std::uint16_t merge_status();
  void switch_off();
  static void switch_off(Member& member);
  void note_enabled(const Request& request);

  std::vector<std::unique_ptr<Member>> members_;
  std::unique_ptr<Links> links_;
  std::map<Ticket, std::unique_ptr<Exchange>> open_;
  Ticket next_ticket_ = 1;
  std::size_t failed_ = 0;  // index of the member that failed last
  mutable LinkStatistics statistics_;
};

}  // namespace kaz::host
