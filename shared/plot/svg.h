// Draws plots as SVG.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/plot/plot.h"

namespace kaz::plot {

// Returns SVG 1.1. The result can be a separate file or a part of an HTML page. Text is stored as SVG text
// elements, not as outlines. So readers can search the text, and viewers draw it with their own font.
std::string plot_svg(const PlotPage& page);

}  // namespace kaz::plot
