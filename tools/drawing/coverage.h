// Picture of the image regions that a camera calibration covers, with the residuals of the board's corners.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/drawing/figure.h"
#include "vision/calibration/stereo_calibration.h"

namespace kaz::figure {

// Draws the image plane of one eye. `width` and `height`: size of the eye's pictures, px. Cells that contain
// corners of the calibration board are tinted. Each corner is a dot with a line that shows its residual,
// enlarged 40 times. The color of dot and line goes from blue at 0 px to red at 1 px.
Image coverage_picture(const vision::EyeQuality& eye, int width, int height);

}  // namespace kaz::figure
