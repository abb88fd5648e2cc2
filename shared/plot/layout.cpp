// Chooses the axes, places the plots and paints them.
// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "shared/plot/curve.h"
#include "shared/plot/style.h"
#include "shared/plot/text.h"

namespace kaz::plot {
namespace {

// All in px.
constexpr double kYLabel = 20, kTickLabelsLeft = 42, kRight = 22;  // from the page's edges
constexpr double kAboveFrame = 34, kBelowFrame = 26;               // title; labels of ticks
constexpr double kTitleAboveFrame = 11, kTickLength = 4;
constexpr double kPageTop = 6, kPageTitle = 40,
                 kFoot = 26;  // of the page; the foot has the x label
constexpr double kCaptionLine = 16, kAfterCaption = 8;
// Beyond so many lengths of the axis values are drawn as if they were there, to stay finite.
constexpr double kFarAway = 1e6;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool empty() const { return low > high; }
};

std::string with_factor(const std::string& label, const Axis& axis) {
  return axis.factor().empty() ? label : label + " (× " + axis.factor() + ")";
}

std::size_t length(const Series& series) {
  return std::min(series.x.size(), series.y.size());
}

Axis y_axis(const LinePlot& plot, Range range) {
  for (const HorizontalLine& line : plot.lines) {
    if (std::isfinite(line.y)) range.include(line.y);
  }
  const auto end = [](const std::optional<double>& limit) {
    return limit ? Axis::End::exact : Axis::End::whole_step;
  };
  return Axis::linear(plot.y_min.value_or(range.low), plot.y_max.value_or(range.high), 5,
                      end(plot.y_min), end(plot.y_max));
}

}  // namespace

Layout::Layout(const PlotPage& page) : page_(page) {
  choose_axes();
  place_plots();
}

bool Layout::shows(double x, double y) const {
  return std::isfinite(x) && std::isfinite(y) && (!page_.x_logarithmic || x > 0);
}

void Layout::choose_axes() {
  Range x;
  for (const LinePlot& plot : page_.plots) {
    Range y;
    for (const Series& series : plot.series) {
      for (std::size_t i = 0; i < length(series); ++i) {
        if (!shows(series.x[i], series.y[i])) continue;
        x.include(series.x[i]);
        y.include(series.y[i]);
      }
    }
    plots_.push_back({.plot = &plot, .y = y_axis(plot, y), .empty = y.empty()});
  }
  const int count = page_.width_px >= 800 ? 10 : 8;
  x_ = page_.x_logarithmic
           ? Axis::logarithmic(x.low, x.high)
           : Axis::linear(x.low, x.high, count, Axis::End::margin, Axis::End::margin);
}

void Layout::place_plots() {
  double labels = 0;
  for (const Placed& placed : plots_) {
    for (const Axis::Tick& tick : placed.y.ticks()) {
      labels = std::max(labels, text_width(tick.label, kTickSize));
    }
  }
  const double left = kTickLabelsLeft + labels;
  const double width = std::max(page_.width_px - kRight - left, 1.0);
  double y = page_.title.empty() ? kPageTop : kPageTitle;
  for (Placed& placed : plots_) {
    const LinePlot& plot = *placed.plot;
    const bool last = &placed == &plots_.back();
    placed.legend = Legend(plot, width, text_width(plot.title, kTitleSize, true));
    placed.frame = {left, y + kAboveFrame + placed.legend.height(), width,
                    std::max(page_.plot_height_px - kAboveFrame - kBelowFrame, 1.0)};
    y = placed.frame.bottom() + (last ? kBelowFrame + kFoot : 0);
    placed.caption = wrapped(plot.caption, width, kTickSize);
    placed.caption_top = y;
    y += static_cast<double>(placed.caption.size()) * kCaptionLine +
         (placed.caption.empty() ? 0 : kAfterCaption) + (last ? 0 : kBelowFrame);
  }
  if (plots_.empty()) y += kFoot;
  height_ = y;
}

Point Layout::place(const Placed& placed, double x, double y) const {
  const Rectangle& frame = placed.frame;
  return {frame.left + std::clamp(x_.at(x), -kFarAway, kFarAway) * frame.width,
          frame.bottom() - std::clamp(placed.y.at(y), -kFarAway, kFarAway) * frame.height};
}

void Layout::paint(Painter& painter) const {
  painter.rectangle({0, 0, size().x, size().y}, kWhite, 1);
  if (!page_.title.empty()) {
    const double left = plots_.empty() ? kYLabel : plots_[0].frame.left;
    painter.text({left, 28}, page_.title, {kPageTitleSize, kInk, Anchor::start, true});
  }
  for (const Placed& placed : plots_) paint_plot(painter, placed, &placed == &plots_.back());
}

void Layout::paint_plot(Painter& painter, const Placed& placed, bool last) const {
  const LinePlot& plot = *placed.plot;
  const Rectangle& frame = placed.frame;
  const Point title{frame.left, frame.top - kTitleAboveFrame - placed.legend.height()};
  const Point center{frame.left + 0.5 * frame.width, frame.top + 0.5 * frame.height};
  painter.rectangle(frame, kBackground, 1);
  paint_spans(painter, placed);
  paint_grid(painter, placed);
  for (const HorizontalLine& line : plot.lines) paint_line(painter, placed, line);
  for (const Series& series : plot.series) paint_series(painter, placed, series);
  painter.line(std::array{Point{frame.left, frame.top}, Point{frame.right(), frame.top},
                          Point{frame.right(), frame.bottom()}, Point{frame.left, frame.bottom()},
                          Point{frame.left, frame.top}},
               kFrameLine, 1, false);
  paint_ticks(painter, placed, last);
  if (placed.empty) painter.text(center, "no data", {kTitleSize, kSoftInk, Anchor::middle});
  painter.text(title, plot.title, {kTitleSize, kInk, Anchor::start, true});
  placed.legend.paint(painter, title);
  painter.text({kYLabel, center.y}, with_factor(plot.y_label, placed.y),
               {kLabelSize, kInk, Anchor::middle, false, true});
  if (last) {
    painter.text({center.x, frame.bottom() + kBelowFrame + 12}, with_factor(page_.x_label, x_),
                 {kLabelSize, kInk, Anchor::middle});
  }
  double y = placed.caption_top;
  for (const std::string& line : placed.caption) {
    painter.text({frame.left, y += kCaptionLine}, line, {kTickSize, kSoftInk});
  }
}

void Layout::paint_spans(Painter& painter, const Placed& placed) const {
  const Rectangle& frame = placed.frame;
  for (const Span& span : placed.plot->spans) {
    // A logarithmic axis has no place for 0 and below: such a span begins at the frame.
    const double from = x_.shows(span.from) ? std::clamp(x_.at(span.from), 0.0, 1.0) : 0;
    const double to = x_.shows(span.to) ? std::clamp(x_.at(span.to), 0.0, 1.0) : 0;
    if (!(to > from)) continue;
    painter.rectangle(
        {frame.left + from * frame.width, frame.top, (to - from) * frame.width, frame.height},
        span.color, 0.13);
  }
}

void Layout::paint_grid(Painter& painter, const Placed& placed) const {
  const Rectangle& frame = placed.frame;
  const auto horizontal = [&](double at, Color color) {
    const double y = frame.bottom() - at * frame.height;
    painter.line(std::array{Point{frame.left, y}, Point{frame.right(), y}}, color, 1, false);
  };
  for (const Axis::Tick& tick : x_.ticks()) {
    const double x = frame.left + tick.at * frame.width;
    painter.line(std::array{Point{x, frame.top}, Point{x, frame.bottom()}},
                 tick.label.empty() ? kSoftGrid : kGrid, 1, false);
  }
  for (const Axis::Tick& tick : placed.y.ticks()) horizontal(tick.at, kGrid);
  if (const double zero = placed.y.at(0); zero > 0 && zero < 1) horizontal(zero, kFrameLine);
}

void Layout::paint_ticks(Painter& painter, const Placed& placed, bool last) const {
  const Rectangle& frame = placed.frame;
  for (const Axis::Tick& tick : x_.ticks()) {
    if (tick.label.empty()) continue;
    const double x = frame.left + tick.at * frame.width;
    painter.line(std::array{Point{x, frame.bottom()}, Point{x, frame.bottom() + kTickLength}},
                 kFrameLine, 1, false);
    if (!last) continue;
    painter.text({x, frame.bottom() + 17}, tick.label, {kTickSize, kInk, Anchor::middle});
  }
  for (const Axis::Tick& tick : placed.y.ticks()) {
    const double y = frame.bottom() - tick.at * frame.height;
    painter.line(std::array{Point{frame.left - kTickLength, y}, Point{frame.left, y}}, kFrameLine,
                 1, false);
    painter.text({frame.left - 7, y + 4}, tick.label, {kTickSize, kInk, Anchor::end});
  }
}

void Layout::paint_line(Painter& painter, const Placed& placed, const HorizontalLine& line) const {
  if (!std::isfinite(line.y)) return;
  const double at = placed.y.at(line.y);
  if (at < 0 || at > 1) return;
  const double y = placed.frame.bottom() - at * placed.frame.height;
  painter.line(std::array{Point{placed.frame.left, y}, Point{placed.frame.right(), y}}, line.color,
               1.4, true);
}

void Layout::paint_series(Painter& painter, const Placed& placed, const Series& series) const {
  const bool connected = series.style != Series::Style::points;
  std::vector<Point> run, dots;
  const auto finish_run = [&] {
    const std::vector<Point> line = thinned(run);
    // Between gaps, or all in one place: a line would not be visible.
    if (line.size() == 1) dots.push_back(line[0]);
    for (const auto& piece : clipped(line, placed.frame)) {
      painter.line(piece, series.color, series.width_px, series.style == Series::Style::dashed);
    }
    run.clear();
  };
  for (std::size_t i = 0; i < length(series); ++i) {
    if (!shows(series.x[i], series.y[i])) {
      finish_run();
      continue;
    }
    (connected ? run : dots).push_back(place(placed, series.x[i], series.y[i]));
  }
  finish_run();
  dots = distinct(dots, placed.frame);
  if (!dots.empty()) {
    painter.dots(dots, series.color, connected ? kLoneDot : kCloudDot, kDotAlpha);
  }
}

}  // namespace kaz::plot
