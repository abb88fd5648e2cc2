// A board's non-volatile memory, kept in a file between runs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

// Loads the file into the board, effective at the next reset. A missing file changes nothing. Errors
// (usage): not a file written by save_memory.
Result<void> load_memory(Mcu& mcu, const std::string& path);
// The bytes of Mcu::memory(), nothing else; the file is replaced as a whole. Errors (environment): the
// file cannot be written.
Result<void> save_memory(const Mcu& mcu, const std::string& path);

}  // namespace kaz::sim
