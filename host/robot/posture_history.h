// History of the postures of the last seconds, searched by host time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "host/robot/posture.h"

namespace kaz::host {

class PostureHistory {
 public:
  // Maximum age of a posture relative to the newest; older postures are removed.
  static constexpr Time kSpan = std::chrono::seconds(5);
  // Maximum difference between the time that at() looks up and the time of the nearest posture.
  static constexpr Time kReach = std::chrono::milliseconds(100);

  // Adds a posture. First removes the entries that have the same time as `posture` or a later time. The
  // removed entries have wrong times, because the board was reset or its clock relation has improved.
  void add(const Posture& posture);

  // Interpolates angles linearly between the postures before and after `t`. Tick, status and supply are
  // copied from the nearer posture. Returns nullopt if `t` is outside the history. Also returns nullopt if
  // the nearer posture is more than kReach away from `t`.
  std::optional<Posture> at(Time t) const;

  std::optional<Time> newest() const;

 private:
  std::deque<Posture> postures_;  // oldest first
};

}  // namespace kaz::host
