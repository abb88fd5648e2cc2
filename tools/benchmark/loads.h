// The loads of the emulator, each from its start to its end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::bench {

// A guest program of sim/h8s/testdata, 1 to 65535 rounds.
Result<void> run_guest(const std::string& guest, const std::string& engine, int rounds);
// The firmware, walking for so long after its start.
Result<void> run_firmware(const std::string& engine, int milliseconds);

}  // namespace kaz::bench
