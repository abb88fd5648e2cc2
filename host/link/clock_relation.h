// Where a board's ticks lie in host time, with a bound on the error.
// SPDX-License-Identifier: Apache-2.0
//
// Each exchange of a request and its reply encloses the start s of the tick that the reply names
// (design, section 3: a tick reads the bytes that came before it, and what it answers leaves from
// the next tick on):
//
//   sent + request_bytes * byte_time  <=  s  <=  received - 1 ms - reply_bytes * byte_time
//
// so offset = s - tick * 1 ms lies in an interval [lo, hi]. Intervals of successive exchanges
// intersect (K. Marzullo, "Maintaining the time in a distributed system", 1983): the exchanges with the
// shortest waits set the bounds. Between exchanges the interval grows on both sides by kDriftBound times
// the elapsed time, because the crystals of board and host differ. With q = (hi - lo) / 2 the result is
//
//   host time of tick = (lo + hi) / 2 + tick * 1 ms, wrong by at most q + kDriftBound * |distance|
//
// with `distance` the time between that tick and the latest exchange. If the intersection is empty
// the board has been reset, or its clock is no crystal (a simulator that lost time): the relation
// starts anew.
#pragma once

#include <cstdint>
#include <optional>

#include "host/link/link.h"

namespace kaz::host {

class ClockRelation {
 public:
  // Crystals of 100 ppm at either end.
  static constexpr double kDriftBound = 200e-6;

  // byte_time: how long one byte takes on the wire; zero if unknown (the bound is then wider).
  explicit ClockRelation(Time byte_time) : byte_time_(byte_time) {}

  struct Exchange {
    Time sent{};      // host time just before the request was written
    Time received{};  // host time just after the last byte of the reply was read
    int bytes_out = 0, bytes_in = 0;
    std::uint32_t tick = 0;
  };
  void add(const Exchange& exchange);

  bool known() const { return known_; }
  // Host time at which `tick` started. `known()` must hold. Right across the wrap of the 32-bit
  // counter for ticks within 24 days of the latest exchange.
  Time host_time(std::uint32_t tick) const;
  // Bound on the error of host_time at the latest exchange: q above.
  Time error_bound() const { return (high_ - low_) / 2; }
  // How often the intersection was empty since the start.
  int restarts() const { return restarts_; }

 private:
  Time ticks_since_origin(std::uint32_t tick) const;

  Time byte_time_;
  bool known_ = false;
  std::uint32_t origin_tick_ = 0;  // of the latest exchange; low_ and high_ enclose its start
  Time latest_{};
  Time low_{}, high_{};
  int restarts_ = 0;
};

}  // namespace kaz::host
