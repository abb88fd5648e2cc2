// Estimates the size of text without a font.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kaz::plot {

// Returns an upper estimate of the text's width, px. The estimate covers common sans-serif fonts, because the
// font of the reader is unknown.
double text_width(const std::string& utf8, double size_px, bool bold = false);

// Breaks the text at spaces into lines of at most `width_px`. A word that is wider than `width_px` gets its
// own line.
std::vector<std::string> wrapped(const std::string& text, double width_px, double size_px);

}  // namespace kaz::plot
