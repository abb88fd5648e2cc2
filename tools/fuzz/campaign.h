// `kaz fuzz`: generates cases from a seed and a corpus, runs them on a board and judges each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::tools {

struct FuzzOptions {
  std::string target = "native";         // native, h8, or a port (KIND:PATH)
  std::string image;                     // firmware, for h8; empty: the built one
  std::string corpus, replay;            // folder of cases; file with one case to run alone
  std::string out = "kaz-fuzz-failure";  // file for a failing case
  double seconds = 10;
  long long cases = 0;  // above 0: number of cases, instead of `seconds`
  std::uint64_t seed = 1;
  bool seed_given = false;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // address of the board at a port
  bool body = false, json = false;            // body: simulate the robot's body, not motors alone
  bool allow_motion = false, wear_flash = false;  // for ports only, which require allow_motion
};

// Prints progress and result. Returns false if a case failed; it is saved to `out`.
Result<bool> fuzz(const FuzzOptions& options);

}  // namespace kaz::tools
