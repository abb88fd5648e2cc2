// `kaz calibrate stereo`: two cameras from pictures of a chessboard.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "vision/calibration/stereo_calibration.h"

namespace kaz::tools {

struct StereoCalibrationOptions {
  std::vector<std::string> left, right;  // files or patterns (picture_pairs.h)
  std::string board;                     // inner corners, "9x6"
  double square_m = 0;                   // side of a square
  std::string out;                       // calibration file, .yml or .json
  std::string coverage;                  // picture; empty: beside `out`
  double max_rms_px = 1;                 // reprojection error above which nothing is written
  bool json = false;
};

// Inner corners as COLUMNSxROWS, 3 to 100 along each side; squares of 0.001 to 0.5 m.
Result<vision::Board> parse_board(const std::string& text, double square_m);
// Writes calibration and coverage picture, prints the report. Errors: usage, or failed where the pictures
// are no basis for a calibration.
Result<bool> calibrate_stereo(StereoCalibrationOptions arguments);

}  // namespace kaz::tools
