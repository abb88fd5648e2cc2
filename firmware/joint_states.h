// Random inputs for tests of the joint loop, with corner values and values at every threshold.
// SPDX-License-Identifier: Apache-2.0
//
// Each field of each joint is drawn from a mixture. The mixture contains corner values (0, 1, -1, the ends of
// the type), values of every magnitude, and uniformly distributed values. Other values are computed from the
// drawn state, close to a threshold of the loop: one below, equal to, or one above the threshold.
//
// These thresholds are covered: range of codes, clamped change of angle, rate at which braking at a limit
// begins, and braking distance. Other covered thresholds are the soft limit on a ramp and the edges of the
// dead band. The rounding and saturation of the duty and the braking drive are also covered.
//
// Fields are independent of each other and of the bounds of requests. Therefore lower limits may exceed upper
// limits, gains may be negative, and ramps may overflow. Inputs for which C and assembler may differ are
// excluded:
//   - `on` other than 0 and 1 in a joint that has dead band or friction but is not constrained. C treats any
//     nonzero value as true. The assembler takes the constrained path for nonzero values other than 1. In the
//     firmware, `on` is one bit, and a joint with dead band or friction is always constrained.
//   - |kp| or |kd| above 32,759 in a constrained joint with friction. The sum can overflow 32 bits, which is
//     undefined in C. Requests set |kp| to at most 8,356 and |kd| to at most 816.
#pragma once

#include <array>
#include <cstdint>

#include "shared/servo/servo.h"

namespace kaz::firmware {

struct LoopInput {
  std::array<kz_joint, KZ_JOINTS> joint{};
  std::array<u16, 256> analog{};  // A/D code for each possible `pot_input`
};

// Draws the input with index `call` for `seed`. The result is the same on every machine and independent of
// earlier calls.
void draw_loop_input(std::uint64_t seed, std::uint64_t call, LoopInput& input);

}  // namespace kaz::firmware
