// Draws plots as SVG.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/plot/plot.h"

namespace kaz::plot {

// Returns SVG 1.1. The result can be a separate file or a part of an HTML page. Text is stored as text, so
// that readers can search the text, and viewers draw the text with their own font.
std::string plot_svg(const PlotPage& page);

}  // namespace kaz::plot
