// Requests and their replies: with one board (Requester), or with several as one (BoardGroup).
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
  bool refused = false;  // the fields are those of kz_refused
  Fields fields;
  // For the clock relation: of the transmission that was answered first. Not `timed` if the request
  // was repeated, for then the reply may be to either transmission.
  bool timed = false;
  Time sent{};  // when its first byte could leave
  Time received{};
  int bytes_out = 0, bytes_in = 0;
};

class Exchanger {
 public:
  virtual ~Exchanger() = default;

  // Posts all requests and waits for all replies, which are in the order of the requests. Fails
  // when one has no reply after all its tries, and when the link fails or is interrupted; then
  // nothing is under way any more.
  virtual Result<std::vector<Reply>> exchange(std::span<const Request> requests) = 0;

  // The same in two steps, so that requests leave while replies to earlier ones come.
  using Ticket = std::uint64_t;
  virtual Result<Ticket> post(const Request& request) = 0;
  // Waits for the reply until `deadline`; nothing if it has not come until then. Each ticket gives
  // its reply once.
  virtual Result<std::optional<Reply>> collect(Ticket ticket, Time deadline) = 0;

  // Sends ahead of all waiting and outstanding requests: for `stop`.
  virtual Result<Reply> exchange_at_once(const Request& request) = 0;

  // Writes a request without waiting for a reply.
  virtual Result<void> send(const Request& request) = 0;

  // Reads until `deadline` or until a telemetry frame has come.
  virtual Result<bool> listen(Time deadline) = 0;
  // Called with each telemetry frame: type, fields, when it was read.
  using Telemetry = std::function<void(std::uint8_t, std::span<const std::uint8_t>, Time)>;
  virtual void on_telemetry(Telemetry receiver) = 0;

  // Discards pending requests and partially received frames, and continues with other sequence numbers.
  virtual void start_anew() = 0;
  // While set, each request has so many tries: for looking whether a board is there at all.
  virtual void limit_tries(std::optional<int> tries) = 0;

  virtual const LinkStatistics& statistics() const = 0;
  // The last frames, one line each (frame_log.h).
  virtual std::string recent_frames() const = 0;
  virtual Link& link() = 0;
  // For messages, of what failed last: the link's name, or that of one of several with the address.
  virtual std::string failed_name() { return link().name(); }
  // Bytes received since the last valid frame, up to 64, for diagnosing what replies there.
  virtual std::span<const std::uint8_t> noise() const = 0;
  // The last failure was that no reply came, not that the link is gone.
  virtual bool timed_out() const = 0;
  // A request of ours came back: the line echoes.
  virtual bool heard_echo() const = 0;
  // When the last request was written; of several boards, to the one that has waited longest.
  virtual Time last_sent() const = 0;
  // Whether one of several boards, other than the one whose ticks replies have, has started anew since
  // the last call.
  virtual bool take_restart() { return false; }
};

}  // namespace kaz::host
