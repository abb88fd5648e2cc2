// Any bytes as an image file.
// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "sim/h8s/chip/chip.h"
#include "sim/h8s/fuzz/targets.h"

namespace kaz::h8s::fuzz {
namespace {

// Checks a loader's result: one sentence on failure, else a consistent image.
std::string check(const Result<Image>& image) {
  if (!image) {
    if (image.error().message.empty()) return "an error without a message";
    if (image.error().message.find('\n') != std::string::npos) return "an error of several lines";
    return {};
  }
  std::size_t total = 0;
  for (const Segment& s : image->segments) total += s.bytes.size();
  if (total > 0x2000000) return "the image is larger than the memory";
  for (const Symbol& symbol : image->symbols.symbols()) {
    if (!image->symbols.address_of(symbol.name)) return "a symbol that is not found";
    (void)image->symbols.describe(symbol.address);
  }
  (void)image->symbols.describe(0);
  (void)image->symbols.describe(0xffffffff);
  Chip chip;
  if (!chip.load(*image)) return {};
  chip.power_on();
  (void)chip.run_until(2000);
  (void)chip.report();
  return {};
}

}  // namespace

std::string image(Bytes input) {
  const std::string_view text(reinterpret_cast<const char*>(input.data()), input.size());
  if (std::string wrong = check(parse_srecord(text, "fuzz")); !wrong.empty()) return wrong;
  if (std::string wrong = check(parse_intel_hex(text, "fuzz")); !wrong.empty()) return wrong;
  if (std::string wrong = check(parse_elf(input, "fuzz")); !wrong.empty()) return wrong;
  return check(parse_coff(input, "fuzz"));
}

}  // namespace kaz::h8s::fuzz
