// The chip: an H8S/2128 with everything on it, executed instruction by instruction.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace kaz::h8s {

// Time in periods of the system clock ("states") since power-on.
using States = std::int64_t;

enum class Port { p1 = 1, p2, p3, p4, p5, p6, p7 };

// Why run_until came back.
struct Stop {
  enum class Reason {
    reached,          // now() >= until
    breakpoint,       // code hook asked to stop
    undefined_instruction,
    unmapped_access,
    stack_outside_ram,
    undefined_register_use,
    asleep_forever,   // SLEEP with nothing that could wake it
  };
  Reason reason = Reason::reached;
  std::string report;  // several lines: what, where (symbol), registers, back-trace, last instructions
};

// (implementation to follow; see the contract in the issue)

}  // namespace kaz::h8s
