// Odometry of the last seconds. Results of images arrive late and need the odometry at the exposure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "host/motion/odometry.h"
#include "shared/base/time.hpp"

namespace kaz::behavior {

// Keeps the newest 200 entries, which cover 2 to 4 s of control cycles.
class PlaceHistory {
 public:
  // Adds an entry. Ignores an entry that is not later than the newest stored entry.
  void add(Time t, const motion::Place& place);
  // Returns the place at `t`, interpolated between entries. If `t` is after the newest entry, returns the
  // newest entry. If `t` is before the oldest entry, returns nothing. The standard deviations are not
  // interpolated, but copied from the entry before `t`.
  std::optional<motion::Place> at(Time t) const;
  void clear() { places_.clear(); }

 private:
  std::deque<std::pair<Time, motion::Place>> places_;
};

}  // namespace kaz::behavior
