// Calibration from the chessboard photographs that come with OpenCV: reprojection error.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "tests/studies/vision_table/table.h"
#include "vision/calibration/stereo_calibration.h"
#include "vision/image/picture_file.h"

namespace kaz::vision_table {

Result<void> measure_boards(const std::string& folder, Table& table) {
  const vision::Board board;
  std::vector<vision::BoardPair> pairs;
  int width = 0, height = 0;
  for (int i = 1; i <= 14; ++i) {
    if (i == 10) continue;  // there is none
    char name[32];
    std::snprintf(name, sizeof name, "%02d.jpg", i);
    const auto left = KAZ_TRY(vision::read_picture(folder + "/left" + name));
    const auto right = KAZ_TRY(vision::read_picture(folder + "/right" + name));
    pairs.push_back({vision::find_board(left, board), vision::find_board(right, board)});
    width = left.width;
    height = left.height;
  }
  const auto result = KAZ_TRY(vision::calibrate_stereo(pairs, board, width, height));
  table.boards = {{"reprojection, left lens only", result.left.rms_px},
                  {"reprojection, right lens only", result.right.rms_px},
                  {"reprojection, both with the transform between them", result.rms_px},
                  {"row difference of a corner in the rectified pictures", result.row_rms_px}};
  return {};
}

}  // namespace kaz::vision_table
