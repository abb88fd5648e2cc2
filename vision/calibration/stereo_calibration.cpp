// Chessboards and the calibration of two eyes by OpenCV.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/stereo_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/calibration/calibration_file.h"
#include "vision/image/opencv_quiet.h"

namespace kaz::vision {
namespace {

using Points = std::vector<cv::Point2f>;

// Up to convergence to a thousandth of a pixel.
const cv::TermCriteria kFine(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 100, 1e-3);
const cv::TermCriteria kFit(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 200, 1e-9);

Points points_of(const Corners& corners) {
  Points points;
  for (const auto& c : corners) points.emplace_back(c.x(), c.y());
  return points;
}

std::vector<cv::Point3f> board_points(const Board& board) {
  std::vector<cv::Point3f> points;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column)
      points.emplace_back(column * board.square_m, row * board.square_m, 0);
  }
  return points;
}

// Half the side of the window for the fine search. A quarter of the narrowest square: the outermost
// squares are often cut to half (those of OpenCV's own pictures are), and a window that reaches the
// edge of the board is drawn to it by px.
int window(const Points& corners, const Board& board) {
  const int columns = board.columns;
  double min_distance = 1e9;
  for (int i = 0; i < columns * board.rows; ++i) {
    const cv::Point2f& here = corners[static_cast<std::size_t>(i)];
    if (i % columns != columns - 1)
      min_distance =
          std::min(min_distance, cv::norm(corners[static_cast<std::size_t>(i + 1)] - here));
    if (i + columns < columns * board.rows)
      min_distance =
          std::min(min_distance, cv::norm(corners[static_cast<std::size_t>(i + columns)] - here));
  }
  return std::clamp(static_cast<int>(min_distance * 0.25), 2, 11);
}

struct OneEye {
  cv::Mat k = cv::Mat::eye(3, 3, CV_64F), d = cv::Mat::zeros(1, 5, CV_64F);
};

double covered(const EyeQuality& eye, int width, int height) {
  std::array<bool, 48> cells{};
  for (const auto& point : eye.points) {
    const int u = std::clamp(static_cast<int>((point.at.x() + 0.5) * 8 / width), 0, 7);
    const int v = std::clamp(static_cast<int>((point.at.y() + 0.5) * 6 / height), 0, 5);
    cells[static_cast<std::size_t>(v * 8 + u)] = true;
  }
  return static_cast<double>(std::count(cells.begin(), cells.end(), true)) / 48;
}

OneEye calibrate_eye(const std::vector<Points>& views, const Board& board, cv::Size size,
                     EyeQuality& quality) {
  OneEye eye;
  const auto object = board_points(board);
  const std::vector<std::vector<cv::Point3f>> objects(views.size(), object);
  std::vector<cv::Mat> turns, shifts;
  cv::Mat sigma, unused, per_view;
  quality.pictures = static_cast<int>(views.size());
  quality.rms_px = cv::calibrateCamera(objects, views, size, eye.k, eye.d, turns, shifts, sigma,
                                       unused, per_view, 0, kFit);
  quality.focal_sigma_px = sigma.at<double>(0);
  for (std::size_t i = 0; i < views.size(); ++i) {
    Points projected;
    cv::projectPoints(object, turns[i], shifts[i], eye.k, eye.d, projected);
    for (std::size_t k = 0; k < projected.size(); ++k) {
      const cv::Point2f seen = views[i][k], off = seen - projected[k];
      quality.points.push_back({{seen.x, seen.y}, {off.x, off.y}});
    }
  }
  quality.covered = covered(quality, size.width, size.height);
  return eye;
}

Lens lens_of(const OneEye& eye) {
  Lens lens{eye.k.at<double>(0, 0),
            eye.k.at<double>(1, 1),
            eye.k.at<double>(0, 2),
            eye.k.at<double>(1, 2),
            {}};
  for (int i = 0; i < 5; ++i) lens.distortion[static_cast<std::size_t>(i)] = eye.d.at<double>(i);
  return lens;
}

// A board looks the same turned by half a turn, except for its colours, and a finder may start at
// either end. Eyes side by side see the same end on the same side.
Corners same_end_first(const Corners& left, Corners right) {
  if ((left.back() - left.front()).dot(right.back() - right.front()) < 0)
    std::reverse(right.begin(), right.end());
  return right;
}

// Squares of the differences of a corner's rows in the rectified pictures.
double sum_of_row_squares(const StereoCalibration& c, const Points& left, const Points& right) {
  const auto row = [&](const StereoCalibration::Eye& eye, const cv::Point2f& p) {
    const Eigen::Vector2d d = eye.lens.direction({p.x, p.y});
    const Eigen::Vector3d ray = eye.rectified_from_camera * d.homogeneous();
    return c.rectified.fy * ray.y() / ray.z() + c.rectified.cy;
  };
  double sum = 0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const double off = row(c.left, left[i]) - row(c.right, right[i]);
    sum += off * off;
  }
  return sum;
}

struct Views {
  std::vector<Points> left, right;            // all of an eye, for the lens alone
  std::vector<Points> both_left, both_right;  // of pairs
  std::vector<std::size_t> pair;              // which ones
};

Views sort(std::span<const BoardPair> pairs) {
  Views views;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [left, right] = pairs[i];
    if (!left.empty()) views.left.push_back(points_of(left));
    if (!right.empty()) views.right.push_back(points_of(right));
    if (left.empty() || right.empty()) continue;
    views.both_left.push_back(points_of(left));
    views.both_right.push_back(points_of(same_end_first(left, right)));
    views.pair.push_back(i);
  }
  return views;
}

Result<StereoResult> fit(const Views& views, std::size_t pairs, const Board& board, cv::Size size) {
  StereoResult result;
  result.pairs.resize(pairs);
  OneEye left = calibrate_eye(views.left, board, size, result.left);
  OneEye right = calibrate_eye(views.right, board, size, result.right);
  const std::vector<std::vector<cv::Point3f>> objects(views.pair.size(), board_points(board));
  cv::Mat r, t, e, f, per_view;
  result.rms_px =
      cv::stereoCalibrate(objects, views.both_left, views.both_right, left.k, left.d, right.k,
                          right.d, size, r, t, e, f, per_view, cv::CALIB_USE_INTRINSIC_GUESS, kFit);
  result.calibration.width = size.width;
  result.calibration.height = size.height;
  result.calibration.left.lens = lens_of(left);
  result.calibration.right.lens = lens_of(right);
  if (!std::isfinite(result.rms_px) || !(left.k.at<double>(0, 0) > 0) ||
      !(right.k.at<double>(0, 0) > 0))
    return fail(Fault::failed,
                "the fit of lenses and board did not converge: take pictures with the board tilted "
                "in different ways");
  Eigen::Matrix3d turn;
  Eigen::Vector3d shift;
  cv::cv2eigen(r, turn);
  cv::cv2eigen(t, shift);
  if (auto done = rectify_pair(result.calibration, turn, shift); !done)
    return fail(Fault::failed, "the pairs cannot be rectified: " + done.error().message);
  double rows = 0;
  const auto corners = static_cast<double>(board.columns * board.rows);
  for (std::size_t i = 0; i < views.pair.size(); ++i) {
    PairQuality& pair = result.pairs[views.pair[i]];
    const double sum =
        sum_of_row_squares(result.calibration, views.both_left[i], views.both_right[i]);
    const int row = static_cast<int>(i);
    pair = {true, per_view.at<double>(row, 0), per_view.at<double>(row, 1),
            std::sqrt(sum / corners)};
    rows += sum;
  }
  result.pairs_used = static_cast<int>(views.pair.size());
  result.row_rms_px = std::sqrt(rows / (corners * result.pairs_used));
  return result;
}

}  // namespace

Corners find_board(const Image& image, const Board& board) {
  const std::size_t bytes =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3;
  if (image.width < 1 || image.height < 1 || image.rgb.size() != bytes || board.columns < 3 ||
      board.rows < 3)
    return {};
  const OpenCvQuiet quiet;
  try {
    const cv::Mat rgb(image.height, image.width, CV_8UC3,
                      const_cast<std::uint8_t*>(image.rgb.data()));  // only read
    cv::Mat grey;
    cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
    Points found;
    if (!cv::findChessboardCorners(grey, cv::Size(board.columns, board.rows), found,
                                   cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
      return {};
    const int half = window(found, board);
    cv::cornerSubPix(grey, found, cv::Size(half, half), cv::Size(-1, -1), kFine);
    Corners corners;
    for (const auto& p : found) corners.emplace_back(p.x, p.y);
    return corners;
  } catch (const cv::Exception&) {  // a picture too small for the search
    return {};
  }
}

Board largest_board(const Image& image, Board board) {
  constexpr int kMore = 4;
  for (int Board::*side : {&Board::columns, &Board::rows}) {
    for (int more = 0; more < kMore; ++more) {
      Board larger = board;
      ++(larger.*side);
      if (find_board(image, larger).empty()) break;
      board = larger;
    }
  }
  return board;
}

Result<StereoResult> calibrate_stereo(std::span<const BoardPair> pairs, const Board& board,
                                      int width, int height) {
  if (board.columns < 3 || board.rows < 3 || !(board.square_m > 0))
    return fail(Fault::usage,
                "a board must have at least 3 x 3 inner corners, and the width of its squares must "
                "be above 0 m");
  const auto corners =
      static_cast<std::size_t>(board.columns) * static_cast<std::size_t>(board.rows);
  for (const auto& pair : pairs) {
    for (const Corners* eye : {&pair.left, &pair.right}) {
      if (!eye->empty() && eye->size() != corners)
        return fail(Fault::usage, "a picture has " + std::to_string(eye->size()) +
                                      " corners, but the board has " + std::to_string(corners));
    }
  }
  const Views views = sort(pairs);
  if (views.pair.size() < static_cast<std::size_t>(kLeastPairs))
    return fail(Fault::failed, "both eyes see the whole board in " +
                                   std::to_string(views.pair.size()) + " of " +
                                   std::to_string(pairs.size()) + " pairs; " +
                                   std::to_string(kLeastPairs) + " are needed");
  const OpenCvQuiet quiet;
  try {
    return fit(views, pairs.size(), board, cv::Size(width, height));
  } catch (const cv::Exception& error) {
    return fail(Fault::failed, "calibration from these pictures failed (" +
                                   error.err.substr(0, error.err.find('\n')) +
                                   "): take pictures with the board tilted in different ways");
  }
}

}  // namespace kaz::vision
