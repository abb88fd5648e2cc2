// Where the robot was, by odometry, over the last seconds: for pictures, whose results come later.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "host/motion/odometry.h"
#include "shared/base/time.hpp"

namespace kaz::behavior {

class PlaceHistory {
 public:
  // In order of time; others are ignored.
  void add(Time t, const motion::Place& place);
  // Interpolated; after the newest entry that one. Nothing before the oldest.
  std::optional<motion::Place> at(Time t) const;
  void clear() { places_.clear(); }

 private:
  std::deque<std::pair<Time, motion::Place>> places_;
};

}  // namespace kaz::behavior
