// Requests to one board and their replies: sequence numbers, time-outs, retries.
// SPDX-License-Identifier: Apache-2.0
//
// A request is repeated with its own sequence number, so that the board can tell a repetition. A
// reply belongs to a request if board address, type and sequence number fit; anything else that is
// sound (late, doubled, of another board) is counted and forgotten. A board that is busy sending is
// asked again a little later, with a new number; requests written together stand so far apart that
// each ends in a tick of its own.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/robot/frame_log.h"
#include "host/robot/link.h"
#include "host/robot/link_statistics.h"
#include "shared/protocol/frame.h"

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
  Time sent{}, received{};
  int bytes_out = 0, bytes_in = 0;
};

struct RequesterOptions {
  std::uint8_t address = 1;
  Time timeout = std::chrono::milliseconds(50);
  int retries = 5;
};

class Requester {
 public:
  Requester(Link& link, Clock& clock, const RequesterOptions& options);

  // Writes all requests at once and waits for all replies, which stand in the order of the
  // requests. Only the last of several may have a reply longer than KZ_TX_PER_TICK, or the board
  // refuses the next. Fails when one has no reply after all its retries, and when the link fails or
  // is interrupted.
  Result<std::vector<Reply>> ask(std::span<const Request> requests);

  // Writes a request and waits for nothing.
  Result<void> tell(const Request& request);

  const LinkStatistics& statistics() const { return statistics_; }
  const FrameLog& frames() const { return frames_; }
  Link& link() { return link_; }
  // What came since the last frame that was sound, for telling what answers there: at most 64
  // bytes.
  std::span<const std::uint8_t> noise() const { return noise_; }
  // The last ask() failed because no reply came, not because the link is gone.
  bool timed_out() const { return timed_out_; }
  // A request of ours came back: the line echoes.
  bool heard_echo() const { return heard_echo_; }

 private:
  struct Waiting;
  std::size_t bytes_per_tick() const;
  void append(Waiting& waiting, std::vector<std::uint8_t>& wire);
  Result<void> write(std::span<const std::uint8_t> wire);
  Result<void> repeat_overdue(std::span<Waiting> all, Time started);
  void take(std::span<const std::uint8_t> bytes, Time now, std::span<Waiting> all);
  void take_frame(Time now, std::span<Waiting> all);

  Link& link_;
  Clock& clock_;
  RequesterOptions options_;
  kz_receiver receiver_{};
  std::uint8_t next_sequence_;
  LinkStatistics statistics_;
  FrameLog frames_;
  std::vector<std::uint8_t> noise_;
  bool heard_echo_ = false;
  bool timed_out_ = false;
};

}  // namespace kaz::host
