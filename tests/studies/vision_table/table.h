// The tables of what vision finds: rows as measured, as Markdown and JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::vision_table {

// Errors of one quantity; percentiles of their size.
class Errors {
 public:
  void add(double error) { values_.push_back(error); }
  bool empty() const { return values_.empty(); }
  double rms() const;
  double bias() const;                    // mean with sign
  double percentile(double share) const;  // of the size; 0..1. 0 where there are none

 private:
  std::vector<double> values_;
};

enum class Sight { whole, cut, hidden };  // cut: by the edge of the picture; hidden: by a board
inline constexpr double kDistances_m[] = {0.2, 0.3, 0.4, 0.6, 0.8, 1.0, 1.25, 1.5};

// A red ball of 20 mm radius somewhere in the picture, at one distance.
struct AccuracyRow {
  int width = 0;
  Sight sight = Sight::whole;
  double distance_m = 0;
  int pictures = 0, found = 0, wrong = 0;  // wrong: found where the ball is not; not in `found`
  Errors center_px, distance;              // distance as a share
};

// Ball, depth and floor under conditions.
struct RobustRow {
  int width = 0;
  std::string group, name;
  int balls = 0, found = 0, wrong = 0;
  int without = 0, false_finds = 0;  // pictures in which there is no such ball
  Errors center_px, distance;
  int textured = 0, known = 0, good = 0;  // pixels
  int floors = 0, floors_found = 0;
  Errors normal_deg, height_mm;
};

struct BoardRow {
  std::string quantity;
  double value_px = 0;
};

struct Table {
  std::vector<AccuracyRow> accuracy;
  std::vector<RobustRow> robust;
  std::vector<BoardRow> boards;

  std::string markdown() const;
  std::string json() const;
};

// Each adds its rows. `pictures`: per row. Errors where OpenGL cannot be had.
Result<void> measure_accuracy(int width, Sight sight, int pictures, Table& table);
// Rows whose group or name is `only`; all where that is empty. Every third picture is without a ball.
Result<void> measure_robustness(int width, int pictures, const std::string& only, Table& table);
// From OpenCV's photographs in `folder`; an error where they are not there.
Result<void> measure_boards(const std::string& folder, Table& table);

}  // namespace kaz::vision_table
