// libFuzzer's entry for all targets of targets.h: --target=NAME chooses one (docs/howto/fuzzing.md).
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tools/fuzz/inputs/targets.h"

namespace {

const kaz::fuzz::Target* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kOption = "--target=";
  for (int i = 1; i < *argc; ++i) {
    const std::string_view argument = (*argv)[i];
    if (!argument.starts_with(kOption)) continue;
    for (const kaz::fuzz::Target& target : kaz::fuzz::kInputTargets) {
      if (argument.substr(kOption.size()) == target.name) chosen = &target;
    }
  }
  if (chosen == nullptr) {
    std::fprintf(stderr, "kaz_fuzz_inputs: give --target=NAME, with one of these names:");
    for (const kaz::fuzz::Target& target : kaz::fuzz::kInputTargets)
      std::fprintf(stderr, " %s", target.name);
    std::fprintf(stderr, "\n");
    std::exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto complaint = chosen->run({data, size});
  if (complaint) {
    std::fprintf(stderr, "%s\n", complaint->c_str());
    std::abort();
  }
  return 0;
}
