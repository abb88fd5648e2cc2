// Description of a page of line plots. svg.h draws the page as SVG, tools/drawing as PNG.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace kaz::plot {

struct Color {
  double r = 0, g = 0, b = 0;  // 0..1, sRGB
};
inline constexpr Color kBlue{0.12, 0.42, 0.75}, kRed{0.84, 0.19, 0.15}, kGreen{0.13, 0.55, 0.30},
    kOrange{0.93, 0.53, 0.11}, kPurple{0.48, 0.32, 0.66}, kGrey{0.45, 0.47, 0.50},
    kYellow{0.98, 0.85, 0.20}, kWhite{1, 1, 1}, kBlack{0, 0, 0};

struct Series {
  enum class Style { line, dashed, points };
  std::string label;  // text in the legend; empty: no entry
  Color color;
  // Coordinates of the points; x and y have equal lengths. If x or y is not finite, the point is not drawn.
  // If the x axis is logarithmic, a point with x <= 0 is not drawn. The line has a gap at each point that is
  // not drawn.
  std::vector<double> x, y;
  double width_px = 1.8;  // width of lines
  Style style = Style::line;
};

inline constexpr std::array kStyles{Series::Style::line, Series::Style::dashed,
                                    Series::Style::points};

// Returns the style's name in files.
constexpr const char* to_string(Series::Style style) {
  switch (style) {
    case Series::Style::line:
      return "line";
    case Series::Style::dashed:
      return "dashed";
    case Series::Style::points:
      break;
  }
  return "points";
}

// Range of x with a tinted background.
struct Span {
  double from = 0, to = 0;
  Color color = kGreen;
  std::string label;  // text in the legend; empty: no entry. Spans with equal labels share an entry
};

// Dashed line over the whole width.
struct HorizontalLine {
  double y = 0;
  Color color = kGrey;
  std::string label;  // text in the legend; empty: no entry
};

struct LinePlot {
  std::string title, y_label;  // with unit: "torque, Nm"
  std::vector<Series> series;
  std::vector<Span> spans;
  std::vector<HorizontalLine> lines;
  std::optional<double> y_min, y_max;  // ends of the y axis; nullopt: chosen from the data
  std::string caption;                 // text below the plot, wrapped into lines
};

// Plots on top of each other with a common x axis.
struct PlotPage {
  std::string title, x_label;
  std::vector<LinePlot> plots;
  int width_px = 960;
  // Height of each plot including title and tick labels. A long legend or a caption increases the height.
  int plot_height_px = 260;
  bool x_logarithmic = false;
};

}  // namespace kaz::plot
