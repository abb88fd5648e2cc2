// libFuzzer's entry: KAZ_FUZZ_TARGET is one of the functions of targets.h.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>

#include "sim/h8s/fuzz/targets.h"

namespace {

// The program whose bits are flipped.
[[maybe_unused]] std::string flipped(kaz::h8s::fuzz::Bytes input) {
  static const auto base = [] {
    const char* path = std::getenv("KAZ_FUZZ_IMAGE");
    auto image = kaz::h8s::load_image(path ? path : KAZ_FUZZ_IMAGE);
    if (!image) {
      std::fprintf(stderr, "%s\n", image.error().message.c_str());
      std::exit(2);
    }
    return *image;
  }();
  return kaz::h8s::fuzz::flipped(base, input);
}

[[maybe_unused]] std::string image(kaz::h8s::fuzz::Bytes input) {
  return kaz::h8s::fuzz::image(input);
}

[[maybe_unused]] std::string chip(kaz::h8s::fuzz::Bytes input) {
  return kaz::h8s::fuzz::chip(input);
}

[[maybe_unused]] std::string gdb(kaz::h8s::fuzz::Bytes input) {
  return kaz::h8s::fuzz::gdb(input);
}

[[maybe_unused]] std::string netlist(kaz::h8s::fuzz::Bytes input) {
  return kaz::h8s::fuzz::netlist(input);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong = KAZ_FUZZ_TARGET({data, size});
  if (!wrong.empty()) {
    std::fprintf(stderr, "%s\n", wrong.c_str());
    std::abort();
  }
  return 0;
}
