// `kaz calibrate stereo`: calibrates two cameras with pictures of a chessboard.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "vision/calibration/stereo_calibration.h"

namespace kaz::tools {

struct StereoCalibrationOptions {
  std::vector<std::string> left, right;  // paths or patterns of picture files (picture_pairs.h)
  std::string board;                     // number of inner corners, for example "9x6"
  double square_m = 0;                   // side length of a square
  std::string out;                       // path of the file (vision::calibration_format())
  // Path of the coverage picture; empty: in the folder of `out`.
  std::string coverage;
  double max_rms_px = 1;  // largest RMS reprojection error of a calibration that is written
  bool json = false;
};

// Parses the number of inner corners, COLUMNSxROWS. Both numbers must be 3 to 100. `square_m`: 0.001 to 0.5.
Result<vision::Board> parse_board(const std::string& text, double square_m);
// Writes the calibration and the coverage picture, and prints the report. Fails with Fault::failed if the
// pictures do not determine a calibration. Fails with Fault::usage for invalid arguments.
Result<bool> calibrate_stereo(StereoCalibrationOptions arguments);

}  // namespace kaz::tools
