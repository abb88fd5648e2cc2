// Paces simulated time by the wall clock.
// SPDX-License-Identifier: Apache-2.0
//
// The class Pacer only calculates; the caller reads the clock.
#pragma once

#include <algorithm>
#include <cstdint>

#include "shared/base/time.hpp"

namespace kaz::sim {

// The simulated time `t` is due when the wall clock shows `origin + t`. A world that is late runs at full
// speed until the delay is made up. If the world is late by more than `tolerance`, the origin is shifted, and
// the delay is counted as lost time. Without this shift, a stall would be followed by a burst of steps.
class Pacer {
 public:
  explicit Pacer(Time tolerance) : tolerance_(tolerance) {}

  void start(Time simulated, Time wall) { origin_ = wall - simulated; }

  // Call this function after the step that ends at `simulated`. Returns the time to wait before the next
  // step.
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
  // If the world is late by more than `tolerance` at the wall time `wall`, returns lost() plus the delay of
  // the world. If the delay is at most `tolerance`, returns lost(). If the process was stopped during a step
  // and has just been continued, the delay is large.
  Time lost_until(Time simulated, Time wall) const {
    const Time late = wall - wall_of(simulated);
    return late > tolerance_ ? lost_ + late : lost_;
  }
  Time worst_late() const { return worst_late_; }

 private:
  Time tolerance_;
  Time origin_{}, lost_{}, worst_late_{};
  std::uint64_t overruns_ = 0;
};

}  // namespace kaz::sim
