// Both maps of a sweep side by side, true edges drawn in, and what was seen when.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/plot/plot.h"
#include "tools/app/figures/frame_information/sweep.h"

namespace kaz::figure7 {

vision::Image panels(const Sweep& sweep);
// The head at exposures and at results, floor in the pictures and in both maps.
plot::PlotPage plots(const Sweep& sweep);

}  // namespace kaz::figure7
