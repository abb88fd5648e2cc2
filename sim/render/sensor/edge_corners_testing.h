// For tests: locates chessboard corners by fitting the edges of the squares.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace kaz::sim {

// A corner is the intersection of two edges. For each edge, a parabola is fitted between the two neighbors of
// the corner. OpenCV's cornerSubPix uses only a small window at the corner. A fit to whole edges averages out
// the steps of rasterization. Units: px and gray codes.
class EdgeCorners {
 public:
  // `found` contains the initial positions of the corners, row by row. `grey` and `found` must outlive this
  // object.
  EdgeCorners(const cv::Mat& grey, const std::vector<cv::Point2f>& found, int columns)
      : grey_(grey),
        found_(found),
        columns_(columns),
        rows_(static_cast<int>(found.size()) / columns) {}

  std::vector<cv::Point2f> corners() const {
    std::vector<cv::Point2f> corners;
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) corners.push_back(corner(column, row));
    }
    return corners;
  }

 private:
  struct Curve {  // points of the curve: at + s along + (c0 + c1 s + c2 s^2) across
    cv::Point2d at, along, across;
    cv::Vec3d c;
    cv::Point2d nearest(const cv::Point2d& p) const {
      const double s = (p - at).dot(along);
      return at + s * along + (c[0] + s * (c[1] + s * c[2])) * across;
    }
  };

  // Returns the initial position of a corner. The board has one more row of squares beyond the outermost
  // corners. For the outer corners of these squares, the position is extrapolated.
  cv::Point2d seed(int column, int row) const {
    const auto at = [&](int x, int y) {
      return cv::Point2d(found_[static_cast<std::size_t>(y * columns_ + x)]);
    };
    const int x = std::clamp(column, 0, columns_ - 1), y = std::clamp(row, 0, rows_ - 1);
    return 2 * at(x, y) - at(2 * x - column, 2 * y - row);
  }

  // Returns the light (square of the code) at p by bilinear interpolation.
  double light(const cv::Point2d& p) const {
    const int x = std::clamp(static_cast<int>(p.x), 0, grey_.cols - 2);
    const int y = std::clamp(static_cast<int>(p.y), 0, grey_.rows - 2);
    const double a = p.x - x, b = p.y - y;
    const auto at = [&](int i, int j) {
      const double code = grey_.at<std::uint8_t>(y + j, x + i);
      return code * code;
    };
    return (1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) + b * ((1 - a) * at(0, 1) + a * at(1, 1));
  }

  // Returns the distance x from `p` along `across` to the edge, in px, in [-reach, reach]. An ideal step at x
  // has the same two levels a and b of light and the same integral of light as the picture. Therefore x =
  // reach (2 (mean - b) / (a - b) - 1).
  double crossing(const cv::Point2d& p, const cv::Point2d& across, double reach) const {
    constexpr int kSteps = 64;
    std::array<double, kSteps> codes{};
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      codes[static_cast<std::size_t>(i)] =
          light(p + (reach * ((i + 0.5) * 2 / kSteps - 1)) * across);
      sum += codes[static_cast<std::size_t>(i)];
    }
    double first = 0, last = 0;
    for (std::size_t i = 0; i < kSteps / 8; ++i) {
      first += codes[i] / (kSteps / 8);
      last += codes[kSteps - 1 - i] / (kSteps / 8);
    }
    return reach * (2 * (sum / kSteps - last) / (first - last) - 1);
  }

  // Fits a parabola c0 + c1 s + c2 s^2 by least squares to the edge positions between `before` and `after`.
  Curve edge(const cv::Point2d& before, const cv::Point2d& at, const cv::Point2d& after,
             double reach) const {
    Curve curve{at, (after - before) / cv::norm(after - before), {}, {}};
    curve.across = {-curve.along.y, curve.along.x};
    cv::Mat rows, values;
    for (const cv::Point2d& end : {before, after}) {
      const int steps = static_cast<int>(4 * cv::norm(end - at));
      for (int i = 0; i < steps; ++i) {
        const double share = (i + 0.5) / steps;
        // These points are too close to the crossing edges.
        if (share < 0.2 || share > 0.8) continue;
        const cv::Point2d p = at + share * (end - at);
        const double s = (p - at).dot(curve.along);
        rows.push_back(cv::Mat(cv::Matx13d(1, s, s * s)));
        values.push_back((p - at).dot(curve.across) + crossing(p, curve.across, reach));
      }
    }
    cv::Mat solution;
    cv::solve(rows, values, solution, cv::DECOMP_QR);
    curve.c = {solution.at<double>(0), solution.at<double>(1), solution.at<double>(2)};
    return curve;
  }

  // Computes the intersection of the two parabolas by alternating projections.
  cv::Point2f corner(int column, int row) const {
    const cv::Point2d at = seed(column, row), left = seed(column - 1, row),
                      right = seed(column + 1, row), up = seed(column, row - 1),
                      down = seed(column, row + 1);
    const double reach = 0.15 * std::min(cv::norm(right - left), cv::norm(down - up)) / 2;
    const Curve one = edge(left, at, right, reach * 1.5), two = edge(up, at, down, reach * 1.5);
    cv::Point2d p = at;
    for (int i = 0; i < 30; ++i) p = two.nearest(one.nearest(p));
    return p;
  }

  const cv::Mat& grey_;
  const std::vector<cv::Point2f>& found_;
  int columns_, rows_;
};

}  // namespace kaz::sim
