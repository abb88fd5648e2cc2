// Plots as SVG.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/plot/plot.h"

namespace kaz::plot {

// SVG 1.1, for a file of its own or inside an HTML page. Text stays text: it can be searched, and is drawn in
// the reader's font.
std::string plot_svg(const PlotPage& page);

}  // namespace kaz::plot
