// Draws plots as SVG.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/plot/plot.h"

namespace kaz::plot {

// Returns SVG 1.1 for a separate file or inside an HTML page. Text is stored as text, so readers can search
// it, and it is drawn with the reader's font.
std::string plot_svg(const PlotPage& page);

}  // namespace kaz::plot
