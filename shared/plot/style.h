// Colors and sizes shared by all plots.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/plot/plot.h"

namespace kaz::plot {

inline constexpr Color kInk{0.20, 0.22, 0.25}, kSoftInk{0.42, 0.44, 0.47},
    kBackground{0.988, 0.988, 0.992}, kGrid{0.88, 0.89, 0.91}, kSoftGrid{0.93, 0.94, 0.95},
    kFrameLine{0.62, 0.64, 0.67};
inline constexpr double kPageTitleSize = 16, kTitleSize = 13, kLabelSize = 12,
                        kTickSize = 11.5;                                 // px
inline constexpr double kCloudDot = 4.4, kLoneDot = 6, kDotAlpha = 0.75;  // diameters, px

}  // namespace kaz::plot
