// Layout of line plots.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "shared/plot/axis.h"
#include "tools/figure/painter.h"

namespace kaz::figure {

namespace {

using plot::Axis;
using plot::make_axis;

constexpr double kLeft = 76, kRight = 22, kTop = 34, kBottom = 26;  // px around each plot's frame
constexpr double kTitle = 40, kFoot = 26;                           // px of the page
constexpr Color kInk{0.20, 0.22, 0.25}, kGrid{0.88, 0.89, 0.91}, kFrame{0.62, 0.64, 0.67};

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

struct Frame {
  double left, top, width, height;
  Axis x, y;
  Point at(double vx, double vy) const {
    return {left + (vx - x.low) / (x.high - x.low) * width,
            top + (1 - (vy - y.low) / (y.high - y.low)) * height};
  }
};

Axis x_axis(const PlotPage& page) {
  Range range;
  for (const LinePlot& plot : page.plots) {
    for (const Series& s : plot.series) {
      for (const double v : s.x) range.include(v);
    }
  }
  return make_axis(range.low, range.high, 10, false);
}

Axis y_axis(const LinePlot& plot) {
  Range range;
  for (const Series& s : plot.series) {
    for (const double v : s.y) range.include(v);
  }
  for (const HorizontalLine& line : plot.lines) range.include(line.y);
  Axis axis = make_axis(plot.y_min.value_or(range.low), plot.y_max.value_or(range.high), 5, true);
  // A limit that the caller set is kept.
  if (plot.y_min && *plot.y_min < axis.high) axis.low = *plot.y_min;
  if (plot.y_max && *plot.y_max > axis.low) axis.high = *plot.y_max;
  return axis;
}

void paint_grid(Painter& p, const Frame& f, bool with_x_labels) {
  for (const double v : f.x.ticks()) {
    const double x = f.at(v, f.y.low).x;
    p.line(std::array{Point{x, f.top}, Point{x, f.top + f.height}}, kGrid, 1, false);
    if (with_x_labels) {
      p.text({x, f.top + f.height + 17}, f.x.label(v), {11.5, kInk, Anchor::middle});
    }
  }
  for (const double v : f.y.ticks()) {
    const double y = f.at(f.x.low, v).y;
    p.line(std::array{Point{f.left, y}, Point{f.left + f.width, y}}, kGrid, 1, false);
    p.text({f.left - 7, y + 4}, f.y.label(v), {11.5, kInk, Anchor::end});
  }
}

void paint_series(Painter& p, const Frame& f, const Series& s) {
  std::vector<Point> piece;
  const auto flush = [&] {
    if (piece.size() > 1) p.line(piece, s.color, s.width_px, s.dashed);
    piece.clear();
  };
  for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
    if (std::isfinite(s.x[i]) && std::isfinite(s.y[i])) {
      piece.push_back(f.at(s.x[i], s.y[i]));
    } else {
      flush();
    }
  }
  flush();
}

// Right-aligned above the frame, in the title's line.
void paint_legend(Painter& p, const Frame& f, const LinePlot& plot) {
  struct Entry {
    std::string label;
    Color color;
    bool dashed, area;
  };
  std::vector<Entry> entries;
  for (const Series& s : plot.series) {
    if (!s.label.empty()) entries.push_back({s.label, s.color, s.dashed, false});
  }
  for (const HorizontalLine& line : plot.lines) {
    if (!line.label.empty()) entries.push_back({line.label, line.color, true, false});
  }
  for (const Span& span : plot.spans) {
    const bool known = std::any_of(entries.begin(), entries.end(),
                                   [&](const Entry& e) { return e.area && e.label == span.label; });
    if (!span.label.empty() && !known) entries.push_back({span.label, span.color, false, true});
  }
  double x = f.left + f.width;
  for (const Entry& e : entries) x -= 26 + text_width(e.label, 11.5, false) + 18;
  x += 18;
  const double y = f.top - 11;
  for (const Entry& e : entries) {
    if (e.area) {
      p.rectangle({x, y - 8}, 20, 10, e.color, 0.22);
    } else {
      p.line(std::array{Point{x, y - 4}, Point{x + 20, y - 4}}, e.color, 2.2, e.dashed);
    }
    p.text({x + 26, y}, e.label, {11.5, kInk});
    x += 26 + text_width(e.label, 11.5, false) + 18;
  }
}

void paint_plot(Painter& p, const Frame& f, const LinePlot& plot, bool last) {
  p.clip({f.left, f.top}, f.width, f.height);
  for (const Span& span : plot.spans) {
    const double from = f.at(std::max(span.from, f.x.low), 0).x;
    const double to = f.at(std::min(span.to, f.x.high), 0).x;
    if (to > from) p.rectangle({from, f.top}, to - from, f.height, span.color, 0.13);
  }
  p.unclip();
  paint_grid(p, f, last);
  p.clip({f.left, f.top}, f.width, f.height);
  for (const HorizontalLine& line : plot.lines) {
    p.line(std::array{f.at(f.x.low, line.y), f.at(f.x.high, line.y)}, line.color, 1.4, true);
  }
  for (const Series& s : plot.series) paint_series(p, f, s);
  p.unclip();
  const double right = f.left + f.width, bottom = f.top + f.height;
  p.line(std::array{Point{f.left, f.top}, Point{right, f.top}, Point{right, bottom},
                    Point{f.left, bottom}, Point{f.left, f.top}},
         kFrame, 1, false);
  p.text({f.left, f.top - 11}, plot.title, {13, kInk, Anchor::start, true});
  p.text({20, f.top + 0.5 * f.height}, plot.y_label, {12, kInk, Anchor::middle, false, true});
  paint_legend(p, f, plot);
}

}  // namespace

Point page_size(const PlotPage& page) {
  const double title = page.title.empty() ? 6 : kTitle;
  return {static_cast<double>(page.width_px),
          title + static_cast<double>(page.plots.size()) * page.plot_height_px + kFoot};
}

void paint(Painter& painter, const PlotPage& page) {
  const Point size = page_size(page);
  painter.rectangle({0, 0}, size.x, size.y, kWhite, 1);
  double y = 6;
  if (!page.title.empty()) {
    painter.text({kLeft, 28}, page.title, {16, kInk, Anchor::start, true});
    y = kTitle;
  }
  const Axis x = x_axis(page);
  for (std::size_t i = 0; i < page.plots.size(); ++i) {
    const LinePlot& plot = page.plots[i];
    const Frame frame{
        kLeft, y + kTop,    page.width_px - kLeft - kRight, page.plot_height_px - kTop - kBottom,
        x,     y_axis(plot)};
    paint_plot(painter, frame, plot, i + 1 == page.plots.size());
    y += page.plot_height_px;
  }
  painter.text({kLeft + 0.5 * (page.width_px - kLeft - kRight), y + 12}, page.x_label,
               {12, kInk, Anchor::middle});
}

}  // namespace kaz::figure
