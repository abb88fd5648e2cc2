// Keeps a board's non-volatile memory in a file between runs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

// Loads the file into the board's memory. The new contents take effect at the next reset. If the file does
// not exist, the memory is unchanged. Returns Fault::usage if the file does not have the size of
// Mcu::memory().
Result<void> load_memory(Mcu& mcu, const std::string& path);
// Writes the bytes of Mcu::memory() to the file. An existing file is replaced only after all bytes are
// written. Returns Fault::environment if the file cannot be written.
Result<void> save_memory(const Mcu& mcu, const std::string& path);

}  // namespace kaz::sim
