// Whether the C structures of a saved state of the native engine's board are those of a board.
// SPDX-License-Identifier: Apache-2.0
//
// They are restored as they were in memory (archive.hpp, plain()), and the board's C trusts its own state: it
// has no room for checks. These functions check each value that it uses as an index, a length, a mask, a
// divisor, or in a product that has to fit 32 bits. Other values may be unusual, but do no harm.
#pragma once

#include "shared/servo/servo.h"
#include "shared/servo/store.h"
#include "shared/servo/tick.h"

namespace kaz::sim {

bool is_possible(const kz_servo& servo);
bool is_possible(const kz_tick_output& output);
// Of a log of so many blocks, and lines in a copy.
bool is_possible(const kz_store& log, int blocks, int parts);

}  // namespace kaz::sim
