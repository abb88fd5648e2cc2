// Validates the C structures in a saved state of the native engine.
// SPDX-License-Identifier: Apache-2.0
//
// The structures are restored as raw memory (archive.hpp, plain()). The firmware does not check its own
// state, because the chip has no memory to spare for such checks. These functions check each value used as an
// index, length, mask or divisor, or in a product that must fit 32 bits. Other values may be unusual but are
// harmless.
#pragma once

#include "shared/servo/servo.h"
#include "shared/servo/store.h"
#include "shared/servo/tick.h"

namespace kaz::sim {

bool is_possible(const kz_servo& servo);
bool is_possible(const kz_tick_output& output);
// Checks a log of `blocks` flash blocks whose copies have `parts` lines each.
bool is_possible(const kz_store& log, int blocks, int parts);

}  // namespace kaz::sim
