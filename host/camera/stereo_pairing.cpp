// Pairs the pictures of two queues by time.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/stereo_pairing.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace kaz::host {

Time RawPair::gap() const {
  return std::chrono::abs(left.exposure - right.exposure);
}

void StereoPairing::Line::drop_first() {
  frames.pop_front();
  ++alone;
}

void StereoPairing::add(EyeSide side, RawFrame frame) {
  Line& line = lines_[static_cast<std::size_t>(side)];
  if (line.last && frame.exposure <= *line.last) {
    ++line.out_of_order;
    return;
  }
  line.last = frame.exposure;
  line.frames.push_back(std::move(frame));
  if (line.frames.size() > kMostWaiting) line.drop_first();
}

bool StereoPairing::second_is_nearer(const Line& line, Time t) {
  return line.frames.size() > 1 && std::chrono::abs(line.frames[1].exposure - t) <
                                       std::chrono::abs(line.frames[0].exposure - t);
}

std::optional<RawPair> StereoPairing::next() {
  auto& [left, right] = lines_;
  while (!left.frames.empty() && !right.frames.empty()) {
    const Time l = left.frames.front().exposure, r = right.frames.front().exposure;
    Line& earlier = l < r ? left : right;
    const Time other = l < r ? r : l;
    if (other - std::min(l, r) > tolerance_ || second_is_nearer(earlier, other)) {
      earlier.drop_first();
      continue;
    }
    RawPair pair{std::move(left.frames.front()), std::move(right.frames.front())};
    left.frames.pop_front();
    right.frames.pop_front();
    return pair;
  }
  return std::nullopt;
}

}  // namespace kaz::host
