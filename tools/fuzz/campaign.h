// `kaz fuzz`: generates cases from a seed and a corpus, runs the cases on a board, and judges each case.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::tools {

struct FuzzOptions {
  std::string target = "native";  // board under test: native, h8, or a port (KIND:PATH)
  std::string image;              // firmware image for h8; empty: the image of this build
  // Corpus: folder of cases; replay: file with the only case to run.
  std::string corpus, replay;
  std::string out = "kaz-fuzz-failure";  // path to which a failing case is written
  double seconds = 10;
  long long cases = 0;  // above 0: number of cases, instead of `seconds`
  std::uint64_t seed = 1;
  bool seed_given = false;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // address of the board at a port
  bool body = false, json = false;            // body: simulates the robot's body, not only motors
  bool allow_motion = false, wear_flash = false;  // for ports only; a port requires allow_motion
};

// Prints progress and result. Returns false if a case failed. The failing case is saved to `out`.
Result<bool> fuzz(const FuzzOptions& options);

}  // namespace kaz::tools
