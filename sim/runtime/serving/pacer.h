// Pacing of simulated time by a clock on the wall.
// SPDX-License-Identifier: Apache-2.0
//
// Pure arithmetic: the clock is read by the caller.
#pragma once

#include <algorithm>
#include <cstdint>

#include "vision/image/frame.h"  // Time

namespace kaz::sim {

// Simulated time t is due at origin + t. A world that is late catches up, unless it is later than
// `tolerance`: then the origin moves, so that a stall is not followed by a burst, and the loss is
// counted.
class Pacer {
 public:
  explicit Pacer(Time tolerance) : tolerance_(tolerance) {}

  void start(Time simulated, Time wall) { origin_ = wall - simulated; }

  // To be called when the step that ends at `simulated` is done. Returns how long to wait before
  // the next.
  Time step_done(Time simulated, Time wall) {
    const Time late = wall - wall_of(simulated);
    worst_late_ = std::max(worst_late_, late);
    if (late > tolerance_) {
      ++overruns_;
      lost_ += late;
      origin_ += late;
    }
    return std::max(Time::zero(), -late);
  }

  Time wall_of(Time simulated) const { return origin_ + simulated; }
  std::uint64_t overruns() const { return overruns_; }
  Time lost() const { return lost_; }
  Time worst_late() const { return worst_late_; }

 private:
  Time tolerance_;
  Time origin_{}, lost_{}, worst_late_{};
  std::uint64_t overruns_ = 0;
};

}  // namespace kaz::sim
