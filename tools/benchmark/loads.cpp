// The loads that can be run by themselves.
// SPDX-License-Identifier: Apache-2.0
#include "tools/benchmark/benchmark.h"

namespace kaz::bench {

const std::vector<Load>& loads() {
  const auto guest = [](const char* name) {
    return
        [name](const std::string& engine, int rounds) { return run_guest(name, engine, rounds); };
  };
  static const std::vector<Load> all{
      {"mcu.mips.crc", "rounds", guest("crc")},
      {"mcu.mips.matrix", "rounds", guest("matrix")},
      {"mcu.mips.mix", "rounds", guest("mix")},
      {"mcu.firmware_x", "milliseconds", run_firmware},
  };
  return all;
}

}  // namespace kaz::bench
