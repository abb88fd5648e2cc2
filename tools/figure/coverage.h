// Picture of the image regions that a camera calibration covers, with the residuals of the board's corners.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/figure/figure.h"
#include "vision/calibration/stereo_calibration.h"

namespace kaz::figure {

// Draws one eye's picture plane; `width` and `height` are those of the eye, px. Cells that contain corners
// are tinted. Each corner is a dot with its residual, 40 times as long. Its color goes from blue at 0 to red
// at 1 px.
Image coverage_picture(const vision::EyeQuality& eye, int width, int height);

}  // namespace kaz::figure
