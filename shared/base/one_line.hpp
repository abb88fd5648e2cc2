// Sanitizes untrusted text (names in files, paths, replies from a port), so that it fits into one line of
// output.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_ONE_LINE_HPP
#define KAZ_SHARED_BASE_ONE_LINE_HPP

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace kaz {

// Returns the length of the UTF-8 character that begins at `at`. Returns 0 if the character is invalid, or
// `at` is the end of the text. RFC 3629: no overlong forms, no surrogates, at most U+10FFFF.
inline std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const unsigned first = byte(at);
  if (first < 0x80) return at < text.size() ? 1 : 0;
  const std::size_t length = first >= 0xc2 && first < 0xe0   ? 2
                             : first >= 0xe0 && first < 0xf0 ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(at + k) & 0xc0U) != 0x80) return 0;
  }
  const unsigned second = byte(at + 1);
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second >= 0xa0) ||
      (first == 0xf0 && second < 0x90) || (first == 0xf4 && second >= 0x90))
    return 0;
  return length;
}

// Returns `text` as one line. Line breaks and tabs become spaces. Other control characters and bytes that
// are not UTF-8 become \xNN. The control characters include U+0080 to U+009F, which terminals interpret.
inline std::string one_line(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const auto c = static_cast<unsigned char>(text[at]);
    const std::size_t length = utf8_length(text, at);
    const bool c1 = length == 2 && c == 0xc2 && static_cast<unsigned char>(text[at + 1]) < 0xa0;
    if (c == '\n' || c == '\r' || c == '\t') {
      out += ' ';
    } else if (c < 0x20 || c == 0x7f || length == 0 || c1) {
      char hex[8];
      std::snprintf(hex, sizeof hex, "\\x%02x", static_cast<unsigned>(c));
      out += hex;
      if (c1) {
        std::snprintf(hex, sizeof hex, "\\x%02x",
                      static_cast<unsigned>(static_cast<unsigned char>(text[at + 1])));
        out += hex;
      }
    } else {
      out += text.substr(at, length);
    }
    at += length == 0 ? 1 : length;
  }
  return out;
}

// Returns the first `max` bytes of `text`, or slightly fewer, so that no UTF-8 character is cut. "..."
// replaces the rest.
inline std::string cut_text(std::string_view text, std::size_t max = 80) {
  if (text.size() <= max) return std::string(text);
  std::size_t end = max;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80) --end;
  return std::string(text.substr(0, end)) + "...";
}

// Returns `text` as one line of at most 200 bytes. Error messages use this function to quote an argument of
// the user.
inline std::string shown_text(std::string_view text) {
  return cut_text(one_line(text), 197);
}

}  // namespace kaz

#endif
