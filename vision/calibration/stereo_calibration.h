// Calibrates two eyes from pictures of a chessboard.
// SPDX-License-Identifier: Apache-2.0
//
// Method: Zhang (2000) as implemented by OpenCV, with subpixel corners. First, each lens is calibrated from
// all pictures in which the whole board is visible. Then both lenses and the transform between the eyes are
// fitted together by least squares of the reprojection error. The center of a pixel has integer coordinates.
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
// and rows. Returns the largest board found. Without this search, the two eyes may detect different parts of
// the same larger board.
Board largest_board(const Image& image, Board board);

struct BoardPair {
  Corners left, right;  // empty if the eye does not see the board
};

struct EyeQuality {
  int pictures = 0;
  double rms_px = 0;  // rms reprojection error if this eye is calibrated alone
  // Standard deviation of the focal length fx, as estimated by cv::calibrateCamera.
  double focal_sigma_px = 0;
  struct Point {
    Eigen::Vector2d at, residual;  // px; residual: measured minus projected
  };
  std::vector<Point> points;
  double covered = 0;  // share of the picture's 8 x 6 cells that contain a corner
};

struct PairQuality {
  // True if both eyes see the board. If `used` is false, all other members are 0.
  bool used = false;
  // Rms reprojection errors in this pair, after the fit of both eyes together.
  double left_rms_px = 0, right_rms_px = 0;
  // Rms difference between the rows of the same corner in the rectified left and right pictures.
  double row_rms_px = 0;
};

struct StereoResult {
  StereoCalibration calibration;
  EyeQuality left, right;
  std::vector<PairQuality> pairs;  // one entry per given pair
  int pairs_used = 0;
  double rms_px = 0;      // rms reprojection error after the fit of both eyes together
  double row_rms_px = 0;  // rms of the row differences of all pairs
};

// Calibrates from pictures of `width` x `height`. Both eyes must see the whole board in at least kLeastPairs
// pairs; otherwise the function returns an error. Also returns an error if the board has fewer than 3 x 3
// inner corners, or if the side of a square is not positive. Also returns an error if the number of corners
// in a picture does not match the board, or if the fit fails.
Result<StereoResult> calibrate_stereo(std::span<const BoardPair> pairs, const Board& board,
                                      int width, int height);

}  // namespace kaz::vision
