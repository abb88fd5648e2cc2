// Talks to the flash writer in a board's RAM (shared/flash/protocol.h): frames, repetitions, windows.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
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
  std::vector<std::uint8_t> data;  // after the status
};

struct WriterInfo {
  int protocol = 0;
  bool by_loader = false;
  std::optional<std::uint16_t> board_id;  // unknown in boot mode
};

// Three sums over a stretch of flash.
struct WriterSums {
  std::uint16_t crc = 0xffff, plain = 0, sums = 0;
  void add(std::uint8_t byte);
  bool operator==(const WriterSums&) const = default;
};

// Big-endian, appended.
void append(std::vector<std::uint8_t>& to, std::uint32_t value, int bytes);
std::string status_text(int status);

class WriterLink {
 public:
  // All must outlive it. `lateness`: the same link and clock where they are real; tries during
  // which this machine was late then do not count, up to LatenessMeter::kRepetitions of an
  // exchange. May be null.
  WriterLink(Link& link, Clock& clock, LatenessMeter* lateness = nullptr)
      : link_(link), clock_(clock), lateness_(lateness) {}

  // One request, repeated until a reply comes. Errors: none came, the link's. A status is no error.
  Result<WriterReply> exchange(const WriterRequest& request, Time patience, int tries = 6);
  // Sends requests in order, up to WINDOW of them outstanding, repeating each as needed. `answered`
  // is called with each reply in order; an error from it ends the exchange. `next` is called when there is
  // room for another request.
  Result<void> exchange_all(
      const std::function<std::optional<WriterRequest>()>& next, Time patience,
      const std::function<Result<void>(const WriterRequest&, const WriterReply&)>& answered);

  Result<WriterInfo> info(Time patience = std::chrono::milliseconds(250), int tries = 6);
  Result<void> set_rate(int baud, std::uint8_t brr);
  Result<WriterSums> sums(std::uint32_t address, std::uint32_t length);

  // Present rate of the link; set_rate() returns to it if the writer does not follow.
  void rate_is(int baud) { rate_ = baud; }
  int repeated() const { return repeated_; }

 private:
  Result<void> send(const WriterRequest& request, std::uint8_t number);
  // A valid frame, or nothing until `deadline`.
  Result<std::optional<WriterReply>> receive(Time deadline);
  bool parse(WriterReply& reply);
  // Waits until the line is quiet. Replies received meanwhile count: the board may only be slow.
  Result<void> settle();
  void begin_try();
  // Whether the try since begin_try() is to be repeated without counting; uses up one of `left`.
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
