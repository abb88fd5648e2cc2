// Calibration of two eyes from pictures of a chessboard.
// SPDX-License-Identifier: Apache-2.0
//
// Zhang's method (2000) as OpenCV has it: corners to a fraction of a pixel, each lens by itself from
// all pictures where its eye sees the whole board, then both lenses and the transform between them
// together, least squares of the reprojection error. Pixel centres at integers.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "vision/calibration/calibration.h"

namespace kaz::vision {

// Inner corners: a board of 10 x 7 squares has 9 x 6.
struct Board {
  int columns = 9, rows = 6;
  double square_m = 0.025;
};

// Zhang needs three views; with five lens coefficients to find, fewer than this leave some of them to
// noise.
inline constexpr int kLeastPairs = 5;

// Row by row, px; empty if the board is not completely visible.
using Corners = std::vector<Eigen::Vector2d>;
Corners find_board(const Image& image, const Board& board);
// The board of which `board`, found in the picture, is a part: as many columns and rows as are in sight, up
// to four more of each. Which part of a larger board is found may differ from eye to eye.
Board largest_board(const Image& image, Board board);

struct BoardPair {
  Corners left, right;  // either may be empty
};

struct EyeQuality {
  int pictures = 0;
  double rms_px = 0;          // reprojection error of this eye alone
  double focal_sigma_px = 0;  // standard deviation of fx, by the curvature of the fit
  struct Point {
    Eigen::Vector2d at, residual;  // px; residual: seen minus projected
  };
  std::vector<Point> points;
  double covered = 0;  // share of the picture's 8 x 6 cells that hold a corner
};

struct PairQuality {
  bool used = false;                         // both eyes see the board; else the rest is 0
  double left_rms_px = 0, right_rms_px = 0;  // reprojection error of both eyes together
  double row_rms_px = 0;  // between the rows of a corner in the rectified pictures
};

struct StereoResult {
  StereoCalibration calibration;
  EyeQuality left, right;
  std::vector<PairQuality> pairs;  // one for each given
  int pairs_used = 0;
  double rms_px = 0;      // reprojection error of both eyes together
  double row_rms_px = 0;  // over all pairs
};

// All pictures are of `width` x `height`. Errors: fewer than kLeastPairs pairs, a board that no
// calibration can come from, a fit that fails.
Result<StereoResult> calibrate_stereo(std::span<const BoardPair> pairs, const Board& board,
                                      int width, int height);

}  // namespace kaz::vision
