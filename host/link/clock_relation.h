// Relates a board's ticks to host time, with a bound on the error.
// SPDX-License-Identifier: Apache-2.0
//
// A reply of the board contains the number of a tick. Let s be the host time at which this tick started. Two
// rules of the board limit s. In a tick, the board reads only bytes that arrived before the start of the
// tick. If the board reads a request in tick n, the reply leaves in tick n + 1 at the earliest. Hence
//
//   sent + request_bytes * byte_time  <=  s  <=  received - 1 ms - reply_bytes * byte_time
//
// So the offset between the two clocks, s - tick * 1 ms, lies in an interval [lo, hi]. Intervals of
// successive exchanges are intersected (Marzullo, "Maintaining the time in a distributed system", 1983), so
// the fastest exchanges set the bounds. The clocks of board and host drift apart between exchanges. So each
// bound of the interval moves outward by kDriftBound times the time since the latest exchange. Let q be (hi -
// lo) / 2. The host time of a tick follows from this formula:
//
//   host time of tick = (lo + hi) / 2 + tick * 1 ms, wrong by at most q + kDriftBound * |distance|
//
// In this formula, `distance` is the time between the tick and the latest exchange. An empty intersection has
// one of two causes: the board was reset, or the board's clock did not run steadily. The clock of a simulator
// on a busy computer can run unsteadily. After an empty intersection, the relation starts again from the
// latest exchange.
#pragma once

#include <cstdint>

#include "host/link/link.h"

namespace kaz::host {

class ClockRelation {
 public:
  // Assumption: the rate of each of the two clocks is wrong by at most 100 ppm. So the two rates differ by at
  // most 200 ppm.
  static constexpr double kDriftBound = 200e-6;

  // `byte_time`: duration of one byte on the wire; zero if unknown. If the byte time is unknown, the error
  // bound is larger.
  explicit ClockRelation(Time byte_time) : byte_time_(byte_time) {}

  struct Exchange {
    Time sent{};      // host time just before the request was written
    Time received{};  // host time just after the reply's last byte was read
    int bytes_out = 0, bytes_in = 0;
    std::uint32_t tick = 0;
  };
  void add(const Exchange& exchange);

  bool known() const { return known_; }
  // Host time at which `tick` started. Requires known(). For ticks within 24 days of the latest exchange, the
  // wrap of the 32-bit counter is taken into account.
  Time host_time(std::uint32_t tick) const;
  // Maximum error of host_time() for the tick of the latest exchange: q in the comment at the top of this
  // file.
  Time error_bound() const { return (high_ - low_) / 2; }
  // Number of empty intersections since construction.
  int restarts() const { return restarts_; }

 private:
  Time ticks_since_origin(std::uint32_t tick) const;

  Time byte_time_;
  bool known_ = false;
  // Tick of the latest exchange; its start is between low_ and high_.
  std::uint32_t origin_tick_ = 0;
  Time latest_{};
  Time low_{}, high_{};
  int restarts_ = 0;
};

}  // namespace kaz::host
