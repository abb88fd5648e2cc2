// What a board remembers without power, kept in a file between two runs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

// Into the board; it is in use after the next reset. A file that does not exist yet changes nothing.
// Errors (usage): another file than save_memory writes.
Result<void> load_memory(Mcu& mcu, const std::string& path);
// The bytes of Mcu::memory(), nothing else; the file is replaced as a whole. Errors (environment): the
// file cannot be written.
Result<void> save_memory(const Mcu& mcu, const std::string& path);

}  // namespace kaz::sim
