// `kaz calibrate stereo`: calibrates two cameras with pictures of a chessboard.
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
  double square_m = 0;                   // length of a side of a square
  std::string out;                       // calibration file, .yml or .json
  std::string coverage;                  // coverage picture; empty: beside `out`
  double max_rms_px = 1;  // largest reprojection error with which the calibration is written
  bool json = false;
};

// Parses the number of inner corners, COLUMNSxROWS, 3 to 100 each. `square_m`: 0.001 to 0.5.
Result<vision::Board> parse_board(const std::string& text, double square_m);
// Writes the calibration and the coverage picture, and prints the report. Fails with Fault::usage, or with
// Fault::failed if the pictures do not determine a calibration.
Result<bool> calibrate_stereo(StereoCalibrationOptions arguments);

}  // namespace kaz::tools
