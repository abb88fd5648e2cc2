// Stores where the robot was during the last 2 to 4 s, according to odometry. The result of an image arrives
// some time after the exposure. PlaceHistory returns the robot's place at the time of the exposure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "host/motion/odometry.h"
#include "shared/base/time.hpp"

namespace kaz::behavior {

// Keeps the newest 200 entries. With one entry per control cycle, the entries cover 2 to 4 s.
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
