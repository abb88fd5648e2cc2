// Widths of characters by class.
// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/text.h"

#include <sstream>
#include <string_view>

namespace kaz::plot {
namespace {

// In units of the font's size. Rounded up from DejaVu Sans, which is wider than most.
double character_width(char c) {
  constexpr std::string_view kNarrow = "fijlrtI.,:;'|!()[]/- ", kWide = "mwMW%@";
  if (kNarrow.find(c) != std::string_view::npos) return 0.41;
  if (kWide.find(c) != std::string_view::npos) return 0.99;
  return c >= 'A' && c <= 'Z' ? 0.74 : 0.64;
}

}  // namespace

double text_width(const std::string& utf8, double size_px, bool bold) {
  double width = 0;
  for (const char c : utf8) {
    if ((c & 0xC0) != 0x80) width += character_width(c);  // UTF-8: not for the bytes that follow
  }
  return width * size_px * (bold ? 1.12 : 1);
}

std::vector<std::string> wrapped(const std::string& text, double width_px, double size_px) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  std::string word;
  while (words >> word) {
    if (!lines.empty() && text_width(lines.back() + " " + word, size_px) <= width_px) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

}  // namespace kaz::plot
