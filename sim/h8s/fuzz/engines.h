// The same chip in each engine, run in lockstep and compared.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/h8s/chip/chip.h"
#include "sim/h8s/fuzz/reader.h"

namespace kaz::h8s::fuzz {

class Engines {
 public:
  Engines(Options options, const Image& image, std::uint8_t ram_fill);

  // Applies `act` to all of them.
  template <class Do>
  void each(Do act) {
    for (Chip& chip : chips_) act(chip);
  }
  // Applies the input's events for at most `states` in all, comparing after each. Empty: all agree.
  std::string play(Reader& input, States states);

 private:
  std::string compare(const std::vector<Stop>& stops) const;
  std::string compare_memory() const;
  void event(Reader& input);

  std::vector<Chip> chips_;
};

}  // namespace kaz::h8s::fuzz
