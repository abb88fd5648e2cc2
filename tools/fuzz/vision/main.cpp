// libFuzzer's entry for one of vision's targets, KAZ_FUZZ_TARGET (docs/howto/fuzzing.md).
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>

#include "tools/fuzz/vision/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto complaint = kaz::fuzz::KAZ_FUZZ_TARGET({data, size});
  if (complaint) {
    std::fprintf(stderr, "%s\n", complaint->c_str());
    std::abort();
  }
  return 0;
}
