// Runs the same chip in lockstep in every engine and compares the results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/h8s/chip/chip.h"
#include "sim/h8s/fuzz/reader.h"

namespace kaz::h8s::fuzz {

// One chip for each engine of this build.
class Engines {
 public:
  Engines(Options options, const Image& image, std::uint8_t ram_fill);

  // Calls `act` with each chip.
  template <class Do>
  void each(Do act) {
    for (Chip& chip : chips_) act(chip);
  }
  // Runs for at most `states` with events from `input`, and compares the engines after each event. Returns
  // the difference; empty if all engines agree.
  std::string play(Reader& input, States states);

 private:
  std::string compare(const std::vector<Stop>& stops) const;
  std::string compare_memory() const;
  void event(Reader& input);

  std::vector<Chip> chips_;
};

}  // namespace kaz::h8s::fuzz
