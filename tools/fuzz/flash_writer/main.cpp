// libFuzzer's entry for the flash writer (docs/howto/fuzzing.md).
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>

#include "tools/fuzz/flash_writer/flash_writer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (const auto complaint = kaz::fuzz::try_flash_writer({data, size})) {
    std::fprintf(stderr, "%s\n%s", complaint->c_str(),
                 kaz::fuzz::flash_writer_text({data, size}).c_str());
    std::abort();
  }
  return 0;
}
