// Where in a picture a calibration has seen the board, and how far off it was there.
// SPDX-License-Identifier: Apache-2.0
#include "tools/drawing/coverage.h"

#include <algorithm>
#include <array>

#include "tools/drawing/surface.h"

namespace kaz::figure {
namespace {

constexpr int kColumns = 8, kRows = 6;  // the cells of EyeQuality::covered
constexpr double kPi = 3.14159265358979323846;
constexpr double kLonger = 40, kWorst_px = 1.0;

void draw_cells(cairo_t* c, const vision::EyeQuality& eye, double width, double height) {
  std::array<int, kColumns * kRows> corners{};
  for (const auto& point : eye.points) {
    const int u =
        std::clamp(static_cast<int>((point.at.x() + 0.5) * kColumns / width), 0, kColumns - 1);
    const int v = std::clamp(static_cast<int>((point.at.y() + 0.5) * kRows / height), 0, kRows - 1);
    ++corners[static_cast<std::size_t>(v * kColumns + u)];
  }
  const double w = width / kColumns, h = height / kRows;
  for (int v = 0; v < kRows; ++v) {
    for (int u = 0; u < kColumns; ++u) {
      if (corners[static_cast<std::size_t>(v * kColumns + u)] > 0) {
        cairo_rectangle(c, u * w, v * h, w, h);
        set_color(c, kGreen, 0.14);
        cairo_fill(c);
      }
      cairo_rectangle(c, u * w, v * h, w, h);
      set_color(c, kGrey, 0.35);
      cairo_set_line_width(c, width / 640);
      cairo_stroke(c);
    }
  }
}

}  // namespace

Image coverage_picture(const vision::EyeQuality& eye, int width, int height) {
  const Surface surface = blank_surface(width, height, kWhite);
  const Context context(cairo_create(surface.get()));
  cairo_t* c = context.get();
  const double unit = width / 640.0;
  draw_cells(c, eye, width, height);
  cairo_translate(c, 0.5, 0.5);  // our pixel centres are at integers, Cairo's at halves
  cairo_set_line_width(c, unit);
  for (const auto& point : eye.points) {
    const double share = std::min(1.0, point.residual.norm() / kWorst_px);
    const Color color{kBlue.r + share * (kRed.r - kBlue.r), kBlue.g + share * (kRed.g - kBlue.g),
                      kBlue.b + share * (kRed.b - kBlue.b)};
    set_color(c, color, 0.8);
    cairo_move_to(c, point.at.x(), point.at.y());
    cairo_rel_line_to(c, kLonger * point.residual.x(), kLonger * point.residual.y());
    cairo_stroke(c);
    cairo_arc(c, point.at.x(), point.at.y(), 1.6 * unit, 0, 2 * kPi);
    cairo_fill(c);
  }
  return image_from(surface.get());
}

}  // namespace kaz::figure
