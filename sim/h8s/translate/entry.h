// What the translator knows of one place in Cpu::code.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::h8s::translate {

struct Entry {
  const void* code = nullptr;  // host code of the block that begins here
  std::uint16_t bound = 0;     // states that must be left, and one more
  bool covered = false;        // part of a translated instruction
  std::uint32_t count = 0;     // times reached by a jump
};
static_assert(sizeof(void*) != 8 || sizeof(Entry) == 16);

}  // namespace kaz::h8s::translate
