// Odometry of the last seconds, for images whose results arrive later.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "host/motion/odometry.h"
#include "shared/base/time.hpp"

namespace kaz::behavior {

// Keeps the newest 200 entries, 2 to 4 s of control cycles.
class PlaceHistory {
 public:
  // Entries not later than the newest are ignored.
  void add(Time t, const motion::Place& place);
  // Returns the place at `t`, interpolated between entries. After the newest entry, it is that one; before
  // the oldest, nothing. The standard deviations are not interpolated: they are those of the entry before
  // `t`.
  std::optional<motion::Place> at(Time t) const;
  void clear() { places_.clear(); }

 private:
  std::deque<std::pair<Time, motion::Place>> places_;
};

}  // namespace kaz::behavior
