// Calibrates two eyes from pictures of a chessboard.
// SPDX-License-Identifier: Apache-2.0
//
// Method: Zhang (2000) as implemented by OpenCV, with subpixel corners. First, each lens is calibrated from
// all pictures in which its eye sees the whole board. Then both lenses and the transform between them are
// fitted together by least squares of the reprojection error. Pixel centers at integers.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "vision/calibration/calibration.h"

namespace kaz::vision {

// Number of inner corners of a chessboard, and side of a square. A board of 10 x 7 squares has 9 x 6 inner
// corners.
struct Board {
  int columns = 9, rows = 6;
  double square_m = 0.025;
};

// Minimum number of pairs. Zhang's method needs only three views, but with fewer than five pairs some of the
// five lens coefficients are determined only by noise.
inline constexpr int kLeastPairs = 5;

// Corners row by row, px; empty if the board is not completely visible.
using Corners = std::vector<Eigen::Vector2d>;
Corners find_board(const Image& image, const Board& board);
// Searches the image for a larger board that contains the detected `board` and has up to four more columns
// and rows. Returns the largest one found. The detected part of a larger board may differ from eye to eye.
Board largest_board(const Image& image, Board board);

struct BoardPair {
  Corners left, right;  // either may be empty
};

struct EyeQuality {
  int pictures = 0;
  double rms_px = 0;  // reprojection error of this eye alone
  // Standard deviation of fx, from the curvature of the least-squares cost.
  double focal_sigma_px = 0;
  struct Point {
    Eigen::Vector2d at, residual;  // px; residual: measured minus projected
  };
  std::vector<Point> points;
  double covered = 0;  // share of the picture's 8 x 6 cells that contain a corner
};

struct PairQuality {
  // True if both eyes see the board; if false, the other members are 0.
  bool used = false;
  double left_rms_px = 0, right_rms_px = 0;  // reprojection error of both eyes together
  // Difference (rms) of the rows of a corner in the rectified pictures.
  double row_rms_px = 0;
};

struct StereoResult {
  StereoCalibration calibration;
  EyeQuality left, right;
  std::vector<PairQuality> pairs;  // one entry per given pair
  int pairs_used = 0;
  double rms_px = 0;      // reprojection error of both eyes together
  double row_rms_px = 0;  // rms row difference over all pairs
};

// Calibrates from pictures of `width` x `height`. Errors: fewer than kLeastPairs pairs in which both eyes see
// the board, fewer than 3 x 3 inner corners, or a failed fit. Another error: the number of corners does not
// match the board.
Result<StereoResult> calibrate_stereo(std::span<const BoardPair> pairs, const Board& board,
                                      int width, int height);

}  // namespace kaz::vision
