// The postures of the last seconds, by host time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "host/robot/posture.h"

namespace kaz::host {

class PostureHistory {
 public:
  static constexpr Time kSpan = std::chrono::seconds(5);
  static constexpr Time kReach = std::chrono::milliseconds(100);

  // A posture that is not newer than the newest known one replaces those it contradicts: the board
  // was reset, or its clock relation improved.
  void add(const Posture& posture);

  // Angles interpolated linearly between the states before and after `t`; tick, status and supply
  // are those of the nearer one. Nothing if `t` lies outside the history or more than kReach from
  // both states.
  std::optional<Posture> at(Time t) const;

  std::optional<Time> newest() const;

 private:
  std::deque<Posture> postures_;  // by rising time
};

}  // namespace kaz::host
