// Estimates of the size of text, without a font.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kaz::plot {

// An estimate on the safe side for common sans-serif fonts, in px: the reader's font is not known.
double text_width(const std::string& utf8, double size_px, bool bold = false);

// Broken at spaces into lines of at most `width_px`; a longer word has a line of its own.
std::vector<std::string> wrapped(const std::string& text, double width_px, double size_px);

}  // namespace kaz::plot
