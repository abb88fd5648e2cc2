// Requests to one board and their replies: sequence numbers, window, time-outs, repetitions.
// SPDX-License-Identifier: Apache-2.0
//
// Requests leave in the order in which they were posted, KZ_REQUESTS_UNDER_WAY of them ahead of
// their replies. A request is repeated with its own sequence number, so that the board recognises a
// repetition and does not execute it twice: when its time-out has come (round_trip.h), or when a request
// sent behind it is answered before it, for a board answers in order. A reply belongs to a request
// if board address, type and sequence number fit; any other valid frame (late, duplicate, of
// another board) is counted and discarded.
//
// An old command never overtakes a newer one: a request that changes something leaves only when
// every earlier one that does is answered. So a repeated request has at most one query behind it, and
// the board, which remembers KZ_REQUESTS_REMEMBERED requests, recognises it. Nor does a query return a state
// from before the command that was posted ahead of it; if the query itself was lost, its reply may be from
// after what follows it, as the tick in the reply shows.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/link/frame_log.h"
#include "host/link/link.h"
#include "host/link/link_statistics.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

struct Fields {
  std::array<std::uint8_t, KZ_PAYLOAD_MAX> bytes{};
  std::uint8_t length = 0;
};

struct Request {
  std::uint8_t type = 0;  // KZ_TYPE_*
  Fields fields;
};

struct Reply {
  bool refused = false;  // the fields are those of kz_refused
  Fields fields;
  // For the clock relation: of the transmission that was answered first. Not `timed` if the request
  // was repeated, for then the reply may be to either transmission.
  bool timed = false;
  Time sent{};  // when its first byte could leave
  Time received{};
  int bytes_out = 0, bytes_in = 0;
};

struct RequesterOptions {
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  RoundTrip::Bounds timeout{std::chrono::milliseconds(50), std::chrono::milliseconds(20),
                            std::chrono::milliseconds(200)};
  Time flash_timeout = std::chrono::seconds(3);  // of requests that write to flash
  int retries = 5;                               // tries after the first
};

class Requester {
 public:
  Requester(Link& link, Clock& clock, const RequesterOptions& options);
  ~Requester();

  // Posts all requests and waits for all replies, which are in the order of the requests. Fails
  // when one has no reply after all its tries, and when the link fails or is interrupted; then
  // nothing is under way any more.
  Result<std::vector<Reply>> exchange(std::span<const Request> requests);

  // The same in two steps, so that requests leave while replies to earlier ones come.
  using Ticket = std::uint64_t;
  Result<Ticket> post(const Request& request);
  // Waits for the reply until `deadline`; nothing if it has not come until then. Each ticket gives
  // its reply once.
  Result<std::optional<Reply>> collect(Ticket ticket, Time deadline);

  // Sends ahead of all waiting and outstanding requests: for `stop`.
  Result<Reply> exchange_at_once(const Request& request);

  // Writes a request without waiting for a reply.
  Result<void> send(const Request& request);

  // Reads until `deadline` or until a telemetry frame has come.
  Result<bool> listen(Time deadline);
  // Called with each telemetry frame: type, fields, when it was read.
  using Telemetry = std::function<void(std::uint8_t, std::span<const std::uint8_t>, Time)>;
  void on_telemetry(Telemetry receiver) { telemetry_ = std::move(receiver); }

  // Discards pending requests and partially received frames, and continues with other sequence numbers.
  void start_anew();
  // While set, each request has so many tries: for looking whether a board is there at all.
  void limit_tries(std::optional<int> tries) { tries_limit_ = tries; }

  const LinkStatistics& statistics() const;
  const FrameLog& frames() const { return frames_; }
  Link& link() { return link_; }
  // Bytes received since the last valid frame, up to 64, for diagnosing what replies there.
  std::span<const std::uint8_t> noise() const { return noise_; }
  // The last failure was that no reply came, not that the link is gone.
  bool timed_out() const { return timed_out_; }
  // A request of ours came back: the line echoes.
  bool heard_echo() const { return heard_echo_; }
  // When the last request was written.
  Time last_sent() const { return last_sent_; }

 private:
  struct Waiting;
  Ticket enqueue(const Request& request, bool at_once);
  Result<void> send_waiting();
  Result<void> pump(Time deadline);
  Result<void> repeat_overdue();
  Result<void> repeat(Waiting& waiting);
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
  Ticket next_ticket_ = 1;
  std::uint64_t transmissions_ = 0;
  std::list<Waiting> queue_;  // in the order in which they may leave
  Time wire_free_{};          // what was written until now has left by then, at the earliest
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
