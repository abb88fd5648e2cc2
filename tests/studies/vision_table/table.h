// Tables of vision accuracy on rendered images against ground truth: rows, Markdown and JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/render/renderer_kind.h"
#include "tools/trials/statistics.h"

namespace kaz::vision_table {

using trials::Errors;

// `cut`: by the image border. `hidden`: partly, by a board.
enum class Visibility { whole, cut, hidden };
inline constexpr double kDistances_m[] = {0.2, 0.3, 0.4, 0.6, 0.8, 1.0, 1.25, 1.5};

// A red ball of 20 mm radius at one distance and random positions in the image.
struct AccuracyRow {
  int width = 0;
  Visibility visibility = Visibility::whole;
  double distance_m = 0;
  int pictures = 0, found = 0, wrong = 0;  // wrong: detected elsewhere; not in `found`
  Errors center_px, distance;              // distance: relative
};

// Ball, depth and floor under one condition.
struct RobustRow {
  int width = 0;
  std::string group, name;
  int balls = 0, found = 0, wrong = 0;
  int without = 0, false_finds = 0;  // images without a ball; detections in them
  Errors center_px, distance;
  // Pixels with texture that both eyes see, those with depth, and those with less than 0.6 px disparity
  // error.
  int textured = 0, known = 0, good = 0;
  int floors = 0, floors_found = 0;
  Errors normal_deg, height_mm;
};

struct BoardRow {
  std::string quantity;
  double value_px = 0;
};

struct Table {
  sim::RendererKind renderer = sim::kDefaultRenderer;  // for all pictures
  std::vector<AccuracyRow> accuracy;
  std::vector<RobustRow> robust;
  std::vector<BoardRow> boards;

  std::string markdown() const;
  std::string json() const;
};

// Returns the required 95th percentile of the relative distance error of a whole ball.
constexpr double max_distance_error(int width, double distance_m) {
  if (width == 320) return distance_m <= 0.6 ? 0.03 : distance_m <= 0.8 ? 0.05 : 0.12;
  return distance_m <= 1.0 ? 0.03 : 0.06;
}

// These functions append rows. `pictures`: number per row. Errors: the renderer does not start.
Result<void> measure_accuracy(int width, Visibility visibility, int pictures, Table& table);
// Measures rows whose group or name is `only`; empty: all. Every third image has no ball.
Result<void> measure_robustness(int width, int pictures, const std::string& only, Table& table);
// Measures OpenCV's photographs in `folder`. Errors: they do not exist.
Result<void> measure_boards(const std::string& folder, Table& table);

}  // namespace kaz::vision_table
