// Status flags that software clears by writing 0 after reading 1.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::h8s {

// `mask`, `byte` and results have the bit positions of the register.
class StickyFlags {
 public:
  std::uint8_t value() const { return set_; }
  bool has(std::uint8_t mask) const { return (set_ & mask) != 0; }
  // Sets flags, as hardware does.
  void raise(std::uint8_t mask) { set_ = static_cast<std::uint8_t>(set_ | mask); }
  // Clears flags without a write by software.
  void drop(std::uint8_t mask) {
    set_ = static_cast<std::uint8_t>(set_ & ~mask);
    seen_ = static_cast<std::uint8_t>(seen_ & ~mask);
  }
  // Must be called for a read by software. Returns the flags. A later write may clear the returned flags.
  std::uint8_t read() {
    seen_ = static_cast<std::uint8_t>(seen_ | set_);
    return set_;
  }
  // Must be called for a write by software. Returns the flags that the write has cleared.
  std::uint8_t write(std::uint8_t byte) {
    const auto cleared = static_cast<std::uint8_t>(set_ & seen_ & ~byte);
    drop(cleared);
    return cleared;
  }

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(set_, seen_);
  }

 private:
  std::uint8_t set_ = 0, seen_ = 0;  // seen_: flags that software has read as 1
};

}  // namespace kaz::h8s
