// Drawing interface of plots, implemented for SVG (svg.cpp) and for pixels (tools/drawing).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "shared/plot/plot.h"

namespace kaz::plot {

struct Point {
  double x = 0, y = 0;  // px, y downwards
  bool operator==(const Point&) const = default;
};

struct Rectangle {
  double left = 0, top = 0, width = 0, height = 0;  // px
  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

enum class Anchor { start, middle, end };

struct TextStyle {
  double size_px = 12;
  Color color;
  Anchor anchor = Anchor::start;
  bool bold = false;
  bool upwards = false;  // rotated by 90 degrees, so that the text reads upward
};

inline constexpr double kDashPx = 6, kDashGapPx = 4;

// Draws shapes; coordinates in px, y downward. Alpha: 0 is invisible, 1 opaque.
class Painter {
 public:
  virtual ~Painter() = default;
  virtual void rectangle(const Rectangle& area, Color fill, double alpha) = 0;
  virtual void line(std::span<const Point> points, Color color, double width_px, bool dashed) = 0;
  // Draws all discs as one shape. If two discs overlap, the common area is not darker than the rest.
  virtual void dots(std::span<const Point> centers, Color color, double diameter_px,
                    double alpha) = 0;
  virtual void text(Point baseline, const std::string& text, const TextStyle& style) = 0;
};

}  // namespace kaz::plot
