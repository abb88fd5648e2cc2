// What a plot is drawn with: a few shapes, to pixels or to SVG.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "tools/figure/figure.h"

namespace kaz::figure {

struct Point {
  double x, y;  // px, y downwards
};

enum class Anchor { start, middle, end };

struct TextStyle {
  double size_px = 12;
  Color color{0.20, 0.22, 0.25};
  Anchor anchor = Anchor::start;
  bool bold = false;
  bool upwards = false;  // turned by 90 degrees, read from below
};

class Painter {
 public:
  virtual ~Painter() = default;
  virtual void rectangle(Point corner, double width, double height, Color fill, double alpha) = 0;
  virtual void line(std::span<const Point> points, Color color, double width_px, bool dashed) = 0;
  virtual void text(Point baseline, const std::string& text, const TextStyle& style) = 0;
  // Lines and rectangles until unclip() show only within this rectangle.
  virtual void clip(Point corner, double width, double height) = 0;
  virtual void unclip() = 0;
};

double text_width(const std::string& text, double size_px, bool bold);
void paint(Painter& painter, const PlotPage& page);
Point page_size(const PlotPage& page);

}  // namespace kaz::figure
