// A seeded host that talks to a board over its serial line.
// SPDX-License-Identifier: Apache-2.0
//
// Covers the protocol's grammar: requests in and out of range, damaged, in pieces, back to back,
// for other boards, with framing errors; telemetry; stores, resets and the loader in some; bytes while
// the board starts. Requests during which the board does not serve the line (store, reset, loader) are sent
// alone: their start depends on how long its CPU was busy, which the native engine does not model
// (wire_differences.h).
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "shared/base/random.hpp"
#include "sim/mcu/mcu.h"
#include "sim/mcu/random_request.h"

namespace kaz::sim {

// Times at which a byte must not end: while a tick reads the receive ring, and around the time at which a
// starting board enables its receiver.
struct WireWindows {
  bool ticks = false;  // the board ticks
  States tick_at = 0;  // when one of the ticks is due
  States closed_from = 0, closed_until = 0;
};

class WireHost {
 public:
  explicit WireHost(std::uint64_t seed);
  WireHost(const WireHost&) = delete;
  WireHost& operator=(const WireHost&) = delete;

  // Events besides bytes.
  enum class Event : std::uint8_t { none, reset_pin, power_cycle };

  // Bytes that end in [from, until), in this order; calls must follow each other without gaps.
  std::vector<SerialByte> bytes(States from, States until, const WireWindows& windows);
  // The event that is due by `at`.
  Event take_event(States at);
  // No more requests; those begun are completed.
  void finish() { finished_ = true; }

  struct Sent {
    States at = 0;  // its last byte ends, or is planned to
    std::string text;
  };
  const std::vector<Sent>& sent() const { return sent_; }
  int requests() const { return requests_; }
  // By kind: "damaged", "in pieces", ...
  const std::map<std::string, std::int64_t>& kinds() const { return kinds_; }

 private:
  enum class Manner : std::uint8_t { polite, burst, damaged, pieces, silent };
  struct Pending {
    std::uint8_t value = 0;
    bool framing_error = false;
    States gap = 0;  // before it
  };
  struct Planned {
    States not_before = 0;                          // since the conversation's beginning
    std::vector<std::vector<std::uint8_t>> bodies;  // type and fields
    States pause = 0;                               // after each
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
  States next_at_ = 0;  // the next request begins
  States min_gap_ = 0;  // from the end of the last request to the next one, at least
  States manner_until_ = 0;
  Manner manner_ = Manner::polite;
  std::deque<Pending> pending_;
  std::deque<Planned> planned_;
  std::vector<std::pair<States, Event>> events_;
  std::uint8_t sequence_ = 0, address_ = KZ_ADDRESS_DEFAULT, other_address_ = KZ_ADDRESS_DEFAULT;
  bool has_moved_ = false;  // set_address was sent: the board may reply to either
  std::vector<std::uint8_t> last_;
  std::vector<Sent> sent_;
  int requests_ = 0;
  std::map<std::string, std::int64_t> kinds_;
};

}  // namespace kaz::sim
