// Draws the results of a sweep: both maps and their errors.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/plot/plot.h"
#include "tools/app/figures/frame_information/sweep.h"

namespace kaz::figure7 {

// Draws both maps side by side, with the true edges.
vision::Image panels(const Sweep& sweep);
// Plots the head's angle at each exposure and at each arrival of a result. Also plots the amount of floor in
// the pictures and in both maps.
plot::PlotPage plots(const Sweep& sweep);

}  // namespace kaz::figure7
