// The option --port PATH[@BAUD].
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/port_argument.h"

#include <charconv>

namespace kaz::tools {

Result<std::pair<std::string, int>> parse_port(const std::string& text) {
  const auto at = text.rfind('@');
  if (at == std::string::npos) return std::pair(text, 115200);
  int baud = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + at + 1, end, baud);
  if (parsed.ec != std::errc() || parsed.ptr != end || baud <= 0 || at == 0) {
    return fail(Fault::usage, "--port " + text + ": give PATH or PATH@BAUD");
  }
  return std::pair(text.substr(0, at), baud);
}

}  // namespace kaz::tools
