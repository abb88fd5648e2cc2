// Collects and arranges the entries of a legend.
// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/legend.h"

#include <algorithm>
#include <array>

#include "shared/plot/style.h"
#include "shared/plot/text.h"

namespace kaz::plot {
namespace {

constexpr double kMarkWidth = 20, kTextOffset = 26, kEntryGap = 18, kLineHeight = 18;  // px

}  // namespace

double Legend::Entry::width() const {
  return kTextOffset + text_width(label, kTickSize);
}

void Legend::collect(const LinePlot& plot) {
  for (const Series& s : plot.series) {
    if (s.label.empty()) continue;
    const Mark mark = s.style == Series::Style::points   ? Mark::dot
                      : s.style == Series::Style::dashed ? Mark::dashed
                                                         : Mark::line;
    entries_.push_back({mark, s.label, s.color});
  }
  for (const HorizontalLine& line : plot.lines) {
    if (!line.label.empty()) entries_.push_back({Mark::dashed, line.label, line.color});
  }
  for (const Span& span : plot.spans) {
    const bool known = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& e) {
      return e.mark == Mark::area && e.label == span.label;
    });
    if (!span.label.empty() && !known) entries_.push_back({Mark::area, span.label, span.color});
  }
}

Legend::Legend(const LinePlot& plot, double width_px, double title_width_px) {
  collect(plot);
  if (entries_.empty()) return;
  double total = -kEntryGap;
  for (const Entry& entry : entries_) total += entry.width() + kEntryGap;
  const bool beside_title = title_width_px + kEntryGap + total <= width_px;
  double x = beside_title ? width_px - total : 0;
  double y = beside_title ? 0 : kLineHeight;
  for (Entry& entry : entries_) {
    if (!beside_title && x > 0 && x + entry.width() > width_px) {
      x = 0;
      y += kLineHeight;
    }
    entry.offset = {x, y};
    x += entry.width() + kEntryGap;
  }
  height_ = y;
}

void Legend::paint(Painter& painter, Point title_baseline) const {
  for (const Entry& entry : entries_) {
    const Point at{title_baseline.x + entry.offset.x, title_baseline.y + entry.offset.y};
    const Point middle{at.x + 0.5 * kMarkWidth, at.y - 4};
    switch (entry.mark) {
      case Mark::area:
        painter.rectangle({at.x, at.y - 9, kMarkWidth, 10}, entry.color, 0.22);
        break;
      case Mark::dot:
        painter.dots(std::array{middle}, entry.color, kLoneDot, kDotAlpha);
        break;
      case Mark::line:
      case Mark::dashed:
        painter.line(std::array{Point{at.x, middle.y}, Point{at.x + kMarkWidth, middle.y}},
                     entry.color, 2.2, entry.mark == Mark::dashed);
    }
    painter.text({at.x + kTextOffset, at.y}, entry.label, {kTickSize, kInk});
  }
}

}  // namespace kaz::plot
