// Reads values from the front of a fuzzer input. After the end of the input, all values are 0.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "sim/h8s/fuzz/targets.h"

namespace kaz::h8s::fuzz {

class Reader {
 public:
  explicit Reader(Bytes bytes) : left_(bytes) {}

  std::uint8_t byte() {
    if (left_.empty()) return 0;
    const std::uint8_t value = left_.front();
    left_ = left_.subspan(1);
    return value;
  }
  // Reads a big-endian number of 1 to 4 bytes.
  std::uint32_t number(int bytes) {
    std::uint32_t value = 0;
    for (int k = 0; k < bytes; ++k) value = value << 8 | byte();
    return value;
  }
  // Returns the next `count` bytes, or fewer if the input ends.
  Bytes take(std::size_t count) {
    const Bytes part = left_.first(std::min(count, left_.size()));
    left_ = left_.subspan(part.size());
    return part;
  }
  Bytes rest() { return take(left_.size()); }
  bool empty() const { return left_.empty(); }

 private:
  Bytes left_;
};

}  // namespace kaz::h8s::fuzz
