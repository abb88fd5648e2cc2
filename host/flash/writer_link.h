// Requests to the flash writer in a board's RAM (shared/flash/protocol.h): frames, retries, windows.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/link/lateness.h"
#include "host/link/link.h"
#include "shared/flash/protocol.h"

namespace kaz::host {

struct WriterRequest {
  std::uint8_t type = 0;
  std::vector<std::uint8_t> payload;
};

struct WriterReply {
  std::uint8_t type = 0, number = 0, status = 0;
  std::vector<std::uint8_t> data;  // payload without its first two bytes (status, reserved byte)
};

struct WriterInfo {
  int protocol = 0;
  bool by_loader = false;
  std::optional<std::uint16_t> board_id;  // empty: unknown, for example in boot mode
};

// Three checksums over a range of flash.
struct WriterSums {
  std::uint16_t crc = 0xffff, plain = 0, sums = 0;
  void add(std::uint8_t byte);
  bool operator==(const WriterSums&) const = default;
};

// Appends `value` as a big-endian number of `bytes` bytes.
void append(std::vector<std::uint8_t>& to, std::uint32_t value, int bytes);
// Returns the meaning of a KZ_WRITER_* status.
std::string status_text(int status);

class WriterLink {
 public:
  // All arguments must outlive this object. `lateness` measures the delays of this process in real time;
  // `lateness` may be null. If `lateness` is not null, the arguments `link` and `clock` must both be
  // `*lateness`. A failed try does not count if this process was delayed during the try. In each exchange,
  // this rule applies to at most LatenessMeter::kRepetitions tries.
  WriterLink(Link& link, Clock& clock, LatenessMeter* lateness = nullptr)
      : link_(link), clock_(clock), lateness_(lateness) {}

  // Sends a request and repeats it until a reply arrives. `patience` is the timeout of each of the first
  // three tries; later tries have twice this timeout. Errors: no reply, or a link error. A reply with status
  // KZ_WRITER_DAMAGED causes another try. A reply with any other error status is returned.
  Result<WriterReply> exchange(const WriterRequest& request, Time patience, int tries = 6);
  // Sends requests in order and repeats a request if its reply is missing. Up to KZ_WRITER_WINDOW requests
  // may wait for replies at the same time. The timeout for a reply is twice the recent response time, limited
  // to the range from `patience` to 4 * `patience`. After the first repetition of a request, its timeout is
  // doubled. After the second and each later repetition, its timeout is three times the original timeout.
  // `next` is called when another request can be sent. `next` must return this request, or nothing if no
  // request is left. `answered` is called with each reply in order; an error from `answered` ends the
  // exchange.
  Result<void> exchange_all(
      const std::function<std::optional<WriterRequest>()>& next, Time patience,
      const std::function<Result<void>(const WriterRequest&, const WriterReply&)>& answered);

  Result<WriterInfo> info(Time patience = std::chrono::milliseconds(250), int tries = 6);
  // Switches the writer and the link to `baud`. `brr`: value for the writer's bit rate register.
  Result<void> set_rate(int baud, std::uint8_t brr);
  Result<WriterSums> sums(std::uint32_t address, std::uint32_t length);

  // Stores the present rate of the link. If the writer does not respond at a new rate, set_rate() restores
  // the stored rate.
  void rate_is(int baud) { rate_ = baud; }
  int repeated() const { return repeated_; }

 private:
  Result<void> send(const WriterRequest& request, std::uint8_t number);
  // Returns a valid frame, or nothing if no valid frame comes by `deadline`.
  Result<std::optional<WriterReply>> receive(Time deadline);
  bool parse(WriterReply& reply);
  // Waits until the line is quiet. Keeps replies that arrive during the wait, because a slow board may have
  // sent them late.
  Result<void> settle();
  void begin_try();
  // Returns whether the try since begin_try() failed because this process was delayed. `left` is the number
  // of tries that can still be excused in this way. Decrements `left` before it returns true.
  bool excused(int& left) const;
  tl::unexpected<Error> no_answer(int tries) const;

  Link& link_;
  Clock& clock_;
  LatenessMeter* lateness_;
  std::uint8_t number_ = 0;
  std::vector<std::uint8_t> buffer_;
  int repeated_ = 0;
  Time took_{};  // recent response time
  int rate_ = 115200;
  bool silent_ = false;  // the last exchange() failed because no reply came
};

}  // namespace kaz::host
