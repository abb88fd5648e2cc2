// Interface for requests and replies, with one board (Requester) or a group of boards (BoardGroup).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

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
  // True: the board refused the request. `fields` then contains a refusal, encoded as kz_refused.
  bool refused = false;
  Fields fields;
  // The class ClockRelation uses the members below. The members describe one transmission of the request: the
  // transmission that the reply answers. If the request was sent more than once, it is uncertain which
  // transmission the reply answers. In this case, `timed` is false.
  bool timed = false;
  Time sent{};  // earliest time at which the first byte of the request could leave
  Time received{};
  int bytes_out = 0, bytes_in = 0;
};

class Exchanger {
 public:
  virtual ~Exchanger() = default;

  // Posts all requests and waits for all replies. Returns the replies in the order of the requests. Fails if
  // a request has no reply after its last try, if the link fails, or if the program is interrupted. After a
  // failure, no request is pending.
  virtual Result<std::vector<Reply>> exchange(std::span<const Request> requests) = 0;

  // With post() and collect(), the host can send a request while earlier replies arrive. exchange() cannot do
  // this. The function post() queues a request and does not wait for its reply.
  using Ticket = std::uint64_t;
  virtual Result<Ticket> post(const Request& request) = 0;
  // Waits until `deadline` for the reply to the request with this ticket. Returns nullopt if the reply has
  // not come by `deadline`. The reply of a ticket is returned only once.
  virtual Result<std::optional<Reply>> collect(Ticket ticket, Time deadline) = 0;

  // Sends `request` ahead of all queued and pending requests and waits for its reply. Use this function for
  // the request `stop`.
  virtual Result<Reply> exchange_at_once(const Request& request) = 0;

  // Writes a request without waiting for a reply.
  virtual Result<void> send(const Request& request) = 0;

  // Reads until `deadline` or until a telemetry frame arrives. Returns whether a frame arrived.
  virtual Result<bool> listen(Time deadline) = 0;
  // Callback for telemetry frames. The arguments are the type, the fields, and the time at which the frame
  // was read. The callback is called from any function that reads from the link.
  using Telemetry = std::function<void(std::uint8_t, std::span<const std::uint8_t>, Time)>;
  virtual void on_telemetry(Telemetry receiver) = 0;

  // Drops pending requests and partial frames. Continues with other sequence numbers.
  virtual void start_anew() = 0;
  // Limits the number of transmissions of each request, for example during a search for a board. nullopt
  // restores the default.
  virtual void limit_tries(std::optional<int> tries) = 0;

  virtual const LinkStatistics& statistics() const = 0;
  // The last 64 frames of each board, one line each (frame_log.h).
  virtual std::string recent_frames() const = 0;
  virtual Link& link() = 0;
  // Name of the link that failed last, for error messages. In a group of boards, the name includes the
  // address of the board.
  virtual std::string failed_name() { return link().name(); }
  // The first 64 bytes since the last valid frame, to diagnose an unknown device.
  virtual std::span<const std::uint8_t> noise() const = 0;
  // Whether the last failure was a missing reply and not a lost link.
  virtual bool timed_out() const = 0;
  // Whether this host received a request. Boards never send requests, so a received request is an echo of a
  // request that the host sent.
  virtual bool heard_echo() const = 0;
  // Time at which the last request was written. For a group of boards, compares the times of the last request
  // to each board and returns the earliest time.
  virtual Time last_sent() const = 0;
  // Whether a board of a group has restarted since the last call. For a single board, always returns false:
  // the caller detects a restart from the tick numbers in the board's replies.
  virtual bool take_restart() { return false; }
};

}  // namespace kaz::host
