// Status flags that software clears by writing 0 after it has read them as 1.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::h8s {

class StickyFlags {
 public:
  std::uint8_t value() const { return set_; }
  bool has(std::uint8_t mask) const { return (set_ & mask) != 0; }
  void raise(std::uint8_t mask) { set_ = static_cast<std::uint8_t>(set_ | mask); }
  // Set by hardware.
  void drop(std::uint8_t mask) {
    set_ = static_cast<std::uint8_t>(set_ & ~mask);
    seen_ = static_cast<std::uint8_t>(seen_ & ~mask);
  }
  std::uint8_t read() {
    seen_ = static_cast<std::uint8_t>(seen_ | set_);
    return set_;
  }
  // Returns the flags that this write has cleared.
  std::uint8_t write(std::uint8_t byte) {
    const auto cleared = static_cast<std::uint8_t>(set_ & seen_ & ~byte);
    drop(cleared);
    return cleared;
  }

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(set_, seen_);
  }

 private:
  std::uint8_t set_ = 0, seen_ = 0;
};

}  // namespace kaz::h8s
