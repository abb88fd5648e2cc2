// Combines left and right pictures into pairs: each picture gets the partner that is nearest in time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "shared/base/time.hpp"

namespace kaz::host {

enum class EyeSide : std::uint8_t { left, right };

// A picture in the camera's format.
struct RawFrame {
  Time exposure{};  // middle of the exposure, host clock
  std::vector<std::uint8_t> bytes;
};

struct RawPair {
  RawFrame left, right;
  // Exposure of the pair: the mean of both exposures.
  Time exposure() const { return left.exposure + (right.exposure - left.exposure) / 2; }
  Time gap() const;  // time between both exposures, never negative
};

class StereoPairing {
 public:
  // Size of each side's queue. If a queue is full, its oldest picture is dropped.
  static constexpr std::size_t kMostWaiting = 8;

  // `tolerance`: maximum time between the exposures of a pair. Recommended: at most half the period of the
  // cameras. Then the first picture within the tolerance is the nearest partner, and pairing does not wait
  // for later pictures.
  explicit StereoPairing(Time tolerance) : tolerance_(tolerance) {}

  // Queues a picture. Drops and counts a picture whose exposure is not later than the exposure of the side's
  // previous picture.
  void add(EyeSide side, RawFrame frame);
  // Returns the next pair, oldest first; nullopt if no pair is complete. Drops pictures that can no longer
  // have a partner.
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
  // Compares the exposures of the first and the second picture in `line`. Returns true if the second exposure
  // is nearer to the time `t`.
  static bool second_is_nearer(const Line& line, Time t);
  const Line& of(EyeSide side) const { return lines_[static_cast<std::size_t>(side)]; }

  Time tolerance_;
  std::array<Line, 2> lines_;
};

}  // namespace kaz::host
