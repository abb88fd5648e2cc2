// Makes errors of flashing diagnostics.
// SPDX-License-Identifier: Apache-2.0
#include "host/flash/diagnostic.h"

#include <algorithm>
#include <cstdio>
#include <span>

#include "shared/base/hex_text.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::host {

tl::unexpected<Error> fail(Fault fault, const Diagnostic& diagnostic) {
  Error error{.fault = fault, .message = one_line(diagnostic.what)};
  const auto add = [&error](const std::string& line) { error.details.push_back(line); };
  if (!diagnostic.expected.empty()) add("expected: " + one_line(diagnostic.expected));
  if (!diagnostic.came.empty()) add("found:    " + one_line(diagnostic.came));
  if (!diagnostic.causes.empty()) add("likely causes, in this order:");
  int number = 0;
  for (const std::string& cause : diagnostic.causes)
    add("  " + std::to_string(++number) + ". " + one_line(cause));
  if (!diagnostic.next.empty()) add("next: " + one_line(diagnostic.next));
  return tl::unexpected(std::move(error));
}

std::string hex_of(const std::vector<std::uint8_t>& bytes) {
  if (bytes.empty()) return "nothing";
  constexpr std::size_t kMaxShown = 16;
  const auto shown = std::span(bytes).first(std::min(bytes.size(), kMaxShown));
  return hex_text(shown, " ") + (bytes.size() > kMaxShown ? " …" : "");
}

std::string hex_address(std::uint32_t address) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%06x", address);
  return text;
}

std::string hex_word(std::uint16_t word) {
  char text[8];
  std::snprintf(text, sizeof text, "%04x", word);
  return text;
}

}  // namespace kaz::host
