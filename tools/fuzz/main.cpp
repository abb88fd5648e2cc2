// libFuzzer's entry: its bytes are a case for the native engine (docs/howto/fuzzing.md).
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>

#include "tools/fuzz/engine_case.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto verdict = kaz::fuzz::run_engine_case({data, data + size}, {});
  if (!verdict) {
    std::fprintf(stderr, "%s\n", verdict.error().message.c_str());
    std::abort();
  }
  if (verdict->violation) {
    std::fprintf(stderr, "%s\n", verdict->violation->c_str());
    std::abort();
  }
  return 0;
}
