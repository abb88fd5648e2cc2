// A plot as SVG, with text as text: inside the HTML page, or as a file of its own.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>
#include <sstream>

#include "hil/bench/report.h"
#include "hil/bench/report/plot_axis.h"
#include "shared/base/xml_text.hpp"

namespace kaz::hil {
namespace {

// All in px.
constexpr double kWidth = 560, kFrameHeight = 240;
constexpr double kRight = 16, kTitle = 30, kLegendLine = 18, kBelowFrame = 44, kCaptionLine = 16;
constexpr double kTextSize = 11, kTitleSize = 13.5;
constexpr const char* kInk = "#33383f";
constexpr const char* kSoft = "#6b7178";
constexpr std::array<const char*, 6> kColors = {"#1f6bbf", "#d63126", "#218c4d",
                                                "#e07b00", "#7a52a8", "#5b636c"};

struct Point {
  double x, y;
  bool operator==(const Point&) const = default;
};

std::string px(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", v);
  return text;
}

std::size_t characters(const std::string& utf8) {
  return static_cast<std::size_t>(
      std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

// A guess, on the safe side: the reader's font is not known.
double text_width(const std::string& text, double size) {
  return 0.56 * size * static_cast<double>(characters(text));
}

std::string text_at(Point at, const std::string& text, const char* anchor, double size,
                    const char* color, const std::string& more = {}) {
  return "<text x=\"" + px(at.x) + "\" y=\"" + px(at.y) + "\" font-size=\"" + px(size) +
         "\" fill=\"" + color + "\" text-anchor=\"" + anchor + "\"" + more + ">" + xml_text(text) +
         "</text>\n";
}

std::string line_from(Point from, Point to, const char* color, double width = 1) {
  return "<line x1=\"" + px(from.x) + "\" y1=\"" + px(from.y) + "\" x2=\"" + px(to.x) + "\" y2=\"" +
         px(to.y) + "\" stroke=\"" + color + "\" stroke-width=\"" + px(width) + "\"/>\n";
}

std::vector<std::string> wrapped(const std::string& text, double width, double size) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  std::string word;
  while (words >> word) {
    if (!lines.empty() && text_width(lines.back() + " " + word, size) <= width) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

bool can_be_shown(const Plot& plot, const std::pair<double, double>& point) {
  return std::isfinite(point.first) && std::isfinite(point.second) &&
         (!plot.x_logarithmic || point.first > 0);
}

class Drawing {
 public:
  explicit Drawing(const Plot& plot) : plot_(plot) {
    Range x, y;
    for (const Series& series : plot.series) {
      for (const auto& point : series.points) {
        if (!can_be_shown(plot, point)) continue;
        x.include(point.first);
        y.include(point.second);
      }
    }
    empty_ = x.low > x.high;
    x_ = plot.x_logarithmic ? PlotAxis::logarithmic(x.low, x.high)
                            : PlotAxis::linear(x.low, x.high, 8, false);
    y_ = PlotAxis::linear(y.low, y.high, 5, true);
    lay_out();
  }

  std::string text() {
    draw_grid();
    draw_labels();
    for (std::size_t i = 0; i < plot_.series.size(); ++i) draw_series(plot_.series[i], color(i));
    if (empty_) {
      body_ += text_at({left_ + width_ / 2, top_ + kFrameHeight / 2}, "no data", "middle",
                       kTitleSize, kSoft);
    }
    draw_legend();
    double y = bottom() + kBelowFrame + kCaptionLine;
    for (const std::string& line : caption_) {
      body_ += text_at({left_, y}, line, "start", kTextSize, kSoft);
      y += kCaptionLine;
    }
    return head() + body_ + "</svg>\n";
  }

 private:
  static const char* color(std::size_t series) { return kColors[series % kColors.size()]; }
  double bottom() const { return top_ + kFrameHeight; }
  double right() const { return left_ + width_; }
  Point place(const std::pair<double, double>& point) const {
    return {left_ + x_.at(point.first) * width_, bottom() - y_.at(point.second) * kFrameHeight};
  }

  void lay_out() {
    double labels = 0;
    for (const auto& tick : y_.ticks())
      labels = std::max(labels, text_width(tick.label, kTextSize));
    left_ = 34 + labels;
    width_ = kWidth - kRight - left_;
    double x = left_;
    int row = 0;
    for (const Series& series : plot_.series) {
      const double wide = 26 + text_width(series.name, kTextSize) + 14;
      if (x + wide > kWidth && x > left_) {
        x = left_;
        ++row;
      }
      legend_.push_back({x, kTitle + row * kLegendLine});
      x += wide;
    }
    const bool has_legend = plot_.series.size() > 1;
    if (!has_legend) legend_.clear();
    top_ = kTitle + (has_legend ? (row + 1) * kLegendLine : 0) + 4;
    caption_ = wrapped(plot_.caption, width_, kTextSize);
    height_ = bottom() + kBelowFrame + static_cast<double>(caption_.size()) * kCaptionLine +
              (caption_.empty() ? 0 : 6);
  }

  std::string head() const {
    const std::string w = px(kWidth), h = px(height_);
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h +
           "\" viewBox=\"0 0 " + w + " " + h +
           "\" role=\"img\" font-family=\"system-ui, sans-serif\">\n<title>" +
           xml_text(plot_.title) + "</title>\n";
  }

  void draw_grid() {
    body_ += "<rect x=\"" + px(left_) + "\" y=\"" + px(top_) + "\" width=\"" + px(width_) +
             "\" height=\"" + px(kFrameHeight) + "\" fill=\"#fcfcfd\" stroke=\"#9ea3ab\"/>\n";
    for (const auto& tick : x_.ticks()) {
      const double x = left_ + tick.at * width_;
      body_ += line_from({x, top_}, {x, bottom()}, tick.label.empty() ? "#eef0f2" : "#e0e2e6");
      if (tick.label.empty()) continue;
      body_ += line_from({x, bottom()}, {x, bottom() + 4}, "#9ea3ab");
      body_ += text_at({x, bottom() + 16}, tick.label, "middle", kTextSize, kInk);
    }
    for (const auto& tick : y_.ticks()) {
      const double y = bottom() - tick.at * kFrameHeight;
      body_ += line_from({left_, y}, {right(), y}, "#e0e2e6");
      body_ += line_from({left_ - 4, y}, {left_, y}, "#9ea3ab");
      body_ += text_at({left_ - 7, y + 4}, tick.label, "end", kTextSize, kInk);
    }
    if (const double zero = y_.at(0); zero > 0 && zero < 1) {
      const double y = bottom() - zero * kFrameHeight;
      body_ += line_from({left_, y}, {right(), y}, "#9ea3ab");
    }
  }

  static std::string with_factor(const std::string& label, const PlotAxis& axis) {
    return axis.factor().empty() ? label : label + " (× " + axis.factor() + ")";
  }

  void draw_labels() {
    body_ += text_at({left_, 18}, plot_.title, "start", kTitleSize, kInk, " font-weight=\"600\"");
    body_ += text_at({left_ + width_ / 2, bottom() + 34}, with_factor(plot_.x_label, x_), "middle",
                     kTextSize, kInk);
    const Point at{14, top_ + kFrameHeight / 2};
    body_ += text_at(at, with_factor(plot_.y_label, y_), "middle", kTextSize, kInk,
                     " transform=\"rotate(-90 " + px(at.x) + " " + px(at.y) + ")\"");
  }

  void draw_series(const Series& series, const char* of_color) {
    if (series.style == Series::Style::points) {
      draw_points(series, of_color);
      return;
    }
    // What cannot be shown interrupts the line.
    std::vector<Point> run;
    for (const auto& point : series.points) {
      if (can_be_shown(plot_, point)) {
        run.push_back(place(point));
      } else {
        draw_line(run, of_color, series.style == Series::Style::dashed);
        run.clear();
      }
    }
    draw_line(run, of_color, series.style == Series::Style::dashed);
  }

  static std::string dot(Point at, const char* of_color) {
    return "<circle cx=\"" + px(at.x) + "\" cy=\"" + px(at.y) + "\" r=\"3\" fill=\"" + of_color +
           "\" fill-opacity=\"0.75\"/>\n";
  }

  // As strokes of zero length, which are short in SVG; points that fall on the same place are drawn once.
  void draw_points(const Series& series, const char* of_color) {
    std::set<std::pair<long, long>> taken;
    std::string path;
    for (const auto& point : series.points) {
      if (!can_be_shown(plot_, point)) continue;
      const Point at = place(point);
      if (!taken.insert({std::lround(2 * at.x), std::lround(2 * at.y)}).second) continue;
      path += 'M';
      path += px(at.x) + "," + px(at.y) + "h0";
    }
    if (path.empty()) return;
    body_ += "<path fill=\"none\" stroke=\"" + std::string(of_color) +
             "\" stroke-width=\"4.4\" stroke-linecap=\"round\" stroke-opacity=\"0.75\" d=\"" +
             path + "\"/>\n";
  }

  void draw_line(const std::vector<Point>& run, const char* of_color, bool dashed) {
    if (run.size() == 1) body_ += dot(run[0], of_color);
    if (run.size() < 2) return;
    body_ += "<polyline fill=\"none\" stroke=\"" + std::string(of_color) +
             "\" stroke-width=\"1.6\" stroke-linejoin=\"round\"" +
             (dashed ? " stroke-dasharray=\"6 4\"" : "") + " points=\"";
    for (const Point& point : thinned(run)) body_ += px(point.x) + "," + px(point.y) + " ";
    body_ += "\"/>\n";
  }

  // Of the points in one column of pixels the first, the lowest, the highest and the last.
  static std::vector<Point> thinned(const std::vector<Point>& run) {
    std::vector<Point> kept;
    const auto by_height = [](const Point& a, const Point& b) { return a.y < b.y; };
    for (auto from = run.begin(); from != run.end();) {
      auto to = from;
      while (to != run.end() && std::floor(to->x) == std::floor(from->x)) ++to;
      auto [low, high] = std::minmax_element(from, to, by_height);
      if (low > high) std::swap(low, high);
      for (const Point& point : {*from, *low, *high, *std::prev(to)}) {
        if (kept.empty() || !(kept.back() == point)) kept.push_back(point);
      }
      from = to;
    }
    return kept;
  }

  void draw_legend() {
    for (std::size_t i = 0; i < legend_.size(); ++i) {
      const Point at = legend_[i];
      const Series& series = plot_.series[i];
      if (series.style == Series::Style::points) {
        body_ += dot({at.x + 9, at.y + 6}, color(i));
      } else {
        draw_line({{at.x, at.y + 6}, {at.x + 18, at.y + 6}}, color(i),
                  series.style == Series::Style::dashed);
      }
      body_ += text_at({at.x + 24, at.y + 10}, series.name, "start", kTextSize, kInk);
    }
  }

  const Plot& plot_;
  PlotAxis x_, y_;
  bool empty_ = true;
  double left_ = 0, top_ = 0, width_ = 0, height_ = 0;
  std::vector<Point> legend_;
  std::vector<std::string> caption_;
  std::string body_;
};

}  // namespace

std::string plot_svg(const Plot& plot) {
  return Drawing(plot).text();
}

}  // namespace kaz::hil
