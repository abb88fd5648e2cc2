// `kaz fuzz`: cases for a board from a seed and a corpus, each judged.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::tools {

struct FuzzOptions {
  std::string target = "native";         // native, h8, or the path of a port
  std::string image;                     // firmware, for h8; empty: the built one
  std::string corpus, replay;            // folder of cases; file with one case
  std::string out = "kaz-fuzz-failure";  // where a failing case is saved
  double seconds = 10;
  long long cases = 0;  // above 0: so many instead of `seconds`
  std::uint64_t seed = 1;
  bool seed_given = false;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // of the board at a port
  bool body = false, json = false;
  bool allow_motion = false, wear_flash = false;  // at a port, which needs the former
};

// Prints progress and result. False: a case failed and was saved.
Result<bool> fuzz(const FuzzOptions& options);

}  // namespace kaz::tools
