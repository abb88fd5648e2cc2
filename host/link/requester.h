// Requests to one board and their replies: sequence numbers, window, timeouts, retries.
// SPDX-License-Identifier: Apache-2.0
//
// Requests leave in the order in which they were posted. Up to KZ_REQUESTS_UNDER_WAY requests may be pending.
// A retry has the sequence number of the first transmission. The board recognizes a retry by its sequence
// number and does not execute the request twice. A request is repeated at its timeout (round_trip.h). A board
// answers in order. If a later request is answered first, the earlier request is repeated. A reply must match
// a pending request in board address, type and sequence number. All other valid frames (late, duplicate, from
// another board) are counted and discarded.
//
// Some requests only switch motors off: `stop`, `enable` with mask 0, `unlock` with 0 seconds, and
// `raw_drive` with duty 0. Each transmission of such a request has a new sequence number, except after a
// refusal as BUSY. Reason: a board with protocol version 2 never executes a repetition (clause REQ-12). A
// reply to any transmission of the request counts. If the reply to a `stop` or to an `enable` with mask 0
// reports that a motor is still on, the request is repeated once. No request reuses one of the last 16
// sequence numbers.
//
// An old command never overtakes a newer command. A request that changes something waits until all earlier
// requests that change something have been answered. While a request that changes something is pending, at
// most one query is pending, too. So between the first transmission of such a request and its repetition, the
// board receives at most one query. The board remembers KZ_REQUESTS_REMEMBERED requests, so the board still
// recognizes the retry. The reply to a query shows the effect of all commands that were posted before the
// query. If the query was lost and repeated, the reply can also show the effect of requests that were posted
// after the query. The tick in the reply is the time of the returned state.
#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/link/exchanger.h"
#include "host/link/frame_log.h"

namespace kaz::host {

struct RequesterOptions {
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  RoundTrip::Bounds timeout{std::chrono::milliseconds(50), std::chrono::milliseconds(20),
                            std::chrono::milliseconds(200)};
  Time flash_timeout = std::chrono::seconds(3);  // timeout of requests that write to flash
  int retries = 5;                               // number of tries after the first one
};

class Requester final : public Exchanger {
 public:
  Requester(Link& link, Clock& clock, const RequesterOptions& options);
  ~Requester() override;

  Result<std::vector<Reply>> exchange(std::span<const Request> requests) override;
  Result<Ticket> post(const Request& request) override;
  Result<std::optional<Reply>> collect(Ticket ticket, Time deadline) override;
  Result<Reply> exchange_at_once(const Request& request) override;
  Result<void> send(const Request& request) override;
  Result<bool> listen(Time deadline) override;
  void on_telemetry(Telemetry receiver) override { telemetry_ = std::move(receiver); }
  void start_anew() override;
  void limit_tries(std::optional<int> tries) override { tries_limit_ = tries; }

  const LinkStatistics& statistics() const override;
  const FrameLog& frames() const { return frames_; }
  std::string recent_frames() const override { return frames_.text(); }
  Link& link() override { return link_; }
  std::span<const std::uint8_t> noise() const override { return noise_; }
  bool timed_out() const override { return timed_out_; }
  bool heard_echo() const override { return heard_echo_; }
  Time last_sent() const override { return last_sent_; }

 private:
  struct Waiting;
  Ticket enqueue(const Request& request, bool at_once);
  Result<void> send_waiting();
  Result<void> pump(Time deadline);
  Result<void> repeat_overdue();
  Result<void> repeat(Waiting& waiting);
  std::uint8_t fresh_sequence();
  void append(Waiting& waiting, std::vector<std::uint8_t>& wire);
  Result<void> write(std::span<const std::uint8_t> wire);
  Result<void> give_up(Error error);
  void take(std::span<const std::uint8_t> bytes, Time now);
  void take_frame(Time now);
  void finish(Waiting& waiting, std::span<const std::uint8_t> fields, bool refused, Time now);
  bool answered_too_early(Waiting& query, Time now);
  void repeat_what_was_lost(const Waiting& answered, Time now);
  int tries() const { return tries_limit_.value_or(options_.retries + 1); }

  Link& link_;
  Clock& clock_;
  RequesterOptions options_;
  Time byte_time_;
  kz_receiver receiver_{};
  std::uint8_t next_sequence_;
  std::deque<std::uint8_t> recent_sequences_;  // the last 16 sequence numbers, oldest first
  Ticket next_ticket_ = 1;
  std::uint64_t transmissions_ = 0;
  std::list<Waiting> queue_;  // requests in the order in which they may leave
  Time wire_free_{};          // earliest time at which the last written byte leaves the port
  Time last_sent_{};
  std::optional<int> tries_limit_;
  RoundTrip round_trip_;
  mutable LinkStatistics statistics_;
  FrameLog frames_;
  std::vector<std::uint8_t> noise_;
  Telemetry telemetry_;
  bool heard_echo_ = false;
  bool timed_out_ = false;
};

}  // namespace kaz::host
