// Interpolation between remembered postures.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/posture_history.h"

#include <algorithm>

namespace kaz::host {

void PostureHistory::add(const Posture& posture) {
  while (!postures_.empty() && postures_.back().time >= posture.time) postures_.pop_back();
  postures_.push_back(posture);
  while (postures_.front().time < posture.time - kSpan) postures_.pop_front();
}

std::optional<Posture> PostureHistory::at(Time t) const {
  const auto after = std::lower_bound(postures_.begin(), postures_.end(), t,
                                      [](const Posture& p, Time time) { return p.time < time; });
  if (after == postures_.end()) return std::nullopt;
  if (after->time == t) return *after;
  if (after == postures_.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const Time to_before = t - before->time, to_after = after->time - t;
  if (std::min(to_before, to_after) > kReach) return std::nullopt;

  Posture posture = to_before <= to_after ? *before : *after;
  const double share = seconds(to_before) / seconds(after->time - before->time);
  for (std::size_t j = 0; j < posture.angle.size(); ++j) {
    posture.angle[j] = before->angle[j] + share * (after->angle[j] - before->angle[j]);
  }
  posture.time = t;
  return posture;
}

std::optional<Time> PostureHistory::newest() const {
  if (postures_.empty()) return std::nullopt;
  return postures_.back().time;
}

}  // namespace kaz::host
