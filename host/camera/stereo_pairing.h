// Which picture of the left camera belongs to which of the right one: the nearest in time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "vision/image/frame.h"

namespace kaz::host {

enum class EyeSide : std::uint8_t { left, right };

// A picture in the camera's format.
struct RawFrame {
  Time exposure{};  // middle of it, host clock
  std::vector<std::uint8_t> bytes;
};

struct RawPair {
  RawFrame left, right;
  // Exposure of the pair: the mean of both.
  Time exposure() const { return left.exposure + (right.exposure - left.exposure) / 2; }
  Time gap() const;  // between both, never negative
};

class StereoPairing {
 public:
  // Size of the queue of each side; the oldest are dropped.
  static constexpr std::size_t kMostWaiting = 8;

  // `tolerance`: maximum difference of the exposures of a pair. Up to half the period of the cameras the
  // first partner within it is also the nearest, so that pairing need not wait for the next picture.
  explicit StereoPairing(Time tolerance) : tolerance_(tolerance) {}

  // A picture that is not newer than the last one of its side is skipped and counted.
  void add(EyeSide side, RawFrame frame);
  // The next pair, oldest first. Drops pictures that can have no partner any more.
  std::optional<RawPair> next();

  Time tolerance() const { return tolerance_; }
  std::uint64_t without_partner(EyeSide side) const { return of(side).alone; }
  std::uint64_t out_of_order(EyeSide side) const { return of(side).out_of_order; }

 private:
  struct Line {
    std::deque<RawFrame> frames;
    std::optional<Time> last;
    std::uint64_t alone = 0, out_of_order = 0;
    void drop_first();
  };
  // True if of two waiting pictures of `line` the second is nearer to `t`.
  static bool second_is_nearer(const Line& line, Time t);
  const Line& of(EyeSide side) const { return lines_[static_cast<std::size_t>(side)]; }

  Time tolerance_;
  std::array<Line, 2> lines_;
};

}  // namespace kaz::host
