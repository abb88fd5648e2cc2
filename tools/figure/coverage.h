// Where in a picture a calibration has seen the board, and how far off it was there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/figure/figure.h"
#include "vision/calibration/stereo_calibration.h"

namespace kaz::figure {

// One eye's picture plane, `width` x `height` px: cells with a corner in them are tinted, each corner
// is a dot with its residual 40 times as long; red from 1 px on.
Image coverage_picture(const vision::EyeQuality& eye, int width, int height);

}  // namespace kaz::figure
