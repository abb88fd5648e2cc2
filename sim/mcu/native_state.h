// Validates the C structures in a saved state of the native engine.
// SPDX-License-Identifier: Apache-2.0
//
// The structures are restored as raw memory (archive.hpp, plain()). The firmware does not check its own
// state, because the chip has too little memory for these checks. These functions check each value that is
// used as an index, length, mask or divisor. If a value is a factor of a product that must fit in 32 bits,
// this value is also checked. Unusual values of other members are harmless.
#pragma once

#include "shared/servo/servo.h"
#include "shared/servo/store.h"
#include "shared/servo/tick.h"

namespace kaz::sim {

bool is_possible(const kz_servo& servo);
bool is_possible(const kz_tick_output& output);
// Checks a log that uses `blocks` flash blocks. Each stored copy in the log has `parts` lines.
bool is_possible(const kz_store& log, int blocks, int parts);

}  // namespace kaz::sim
