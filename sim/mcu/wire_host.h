// A host for random conversations with a board over the serial line. The seed determines the conversation.
// SPDX-License-Identifier: Apache-2.0
//
// The host sends every kind of request of the protocol. Some requests have invalid values, are damaged, or
// address other boards. Some requests arrive in pieces, back to back, or with framing errors. In some
// conversations, the host requests telemetry, a store to flash, a reset, or the loader. In some
// conversations, the host sends bytes while the board starts. While the board stores to flash, resets,
// or runs the loader, the board does not serve the line. Therefore the host pauses before and after each
// request that starts a store, a reset or the loader. The exact time at which the board starts the
// store, the reset or the loader depends on how long the CPU was busy. The native engine does not model how
// long the CPU is busy (wire_differences.h).
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "shared/base/random.hpp"
#include "sim/mcu/mcu.h"
#include "sim/mcu/random_request.h"

namespace kaz::sim {

// Forbidden intervals: the stop bit of a byte from the host must not end within a forbidden interval. In each
// tick, there is a forbidden interval around the time at which the tick reads the receive ring. After a
// reset, there is a forbidden interval from `closed_from` to `closed_until`.
struct WireWindows {
  bool ticks = false;  // whether the board runs ticks
  States tick_at = 0;  // due time of one tick; the other due times follow from the tick period
  // Interval around the time at which the board enables its receiver.
  States closed_from = 0, closed_until = 0;
};

class WireHost {
 public:
  explicit WireHost(std::uint64_t seed);
  WireHost(const WireHost&) = delete;
  WireHost& operator=(const WireHost&) = delete;

  // Events other than bytes.
  enum class Event : std::uint8_t { none, reset_pin, power_cycle };

  // Returns the bytes that end in [from, until), ordered by time. In each call, `from` must be equal to
  // `until` of the previous call.
  std::vector<SerialByte> bytes(States from, States until, const WireWindows& windows);
  // Removes and returns an event that is due by `at`. The event drops all bytes that are not yet sent.
  Event take_event(States at);
  // Ends the conversation: requests in progress are completed, and no other requests begin.
  void finish() { finished_ = true; }

  struct Sent {
    States at = 0;  // planned end of the request's last byte
    std::string text;
  };
  const std::vector<Sent>& sent() const { return sent_; }
  int requests() const { return requests_; }
  // Returns a count for each kind of behavior of the host: "damaged", "in pieces", "silences" and others.
  const std::map<std::string, std::int64_t>& kinds() const { return kinds_; }

 private:
  enum class Manner : std::uint8_t { polite, burst, damaged, pieces, silent };
  struct Pending {
    std::uint8_t value = 0;
    bool framing_error = false;
    States gap = 0;  // idle time before the byte
  };
  struct Planned {
    // Earliest start, counted from the start of the conversation.
    States not_before = 0;
    std::vector<std::vector<std::uint8_t>> bodies;  // type and fields of each request
    States pause = 0;                               // idle time after each body
  };

  void begin(States at);
  void next_manner();
  void refill(States at);
  std::vector<std::uint8_t> frame(const std::vector<std::uint8_t>& request);
  void send(const std::vector<std::uint8_t>& frame, const char* kind, const std::string& text);
  void damage(std::vector<std::uint8_t>& frame);
  std::vector<std::uint8_t> harmless();
  void plan_specials();

  Random random_;
  RandomRequest requests_of_;
  bool begun_ = false, finished_ = false;
  States begun_at_ = 0;
  States line_free_ = 0;
  States next_at_ = 0;  // start of the next request
  States min_gap_ = 0;  // minimum time from the end of a request to the next request
  States manner_until_ = 0;
  Manner manner_ = Manner::polite;
  std::deque<Pending> pending_;
  std::deque<Planned> planned_;
  std::vector<std::pair<States, Event>> events_;
  std::uint8_t sequence_ = 0, address_ = KZ_ADDRESS_DEFAULT, other_address_ = KZ_ADDRESS_DEFAULT;
  // True after the host has sent a request to change the address. From then on, the address of the board may
  // be `address_` or `other_address_`.
  bool has_moved_ = false;
  std::vector<std::uint8_t> last_;
  std::vector<Sent> sent_;
  int requests_ = 0;
  std::map<std::string, std::int64_t> kinds_;
};

}  // namespace kaz::sim
