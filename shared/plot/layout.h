// Lays out and paints a page of plots.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/plot/axis.h"
#include "shared/plot/legend.h"
#include "shared/plot/painter.h"

namespace kaz::plot {

class Layout {
 public:
  // `page` must outlive the layout.
  explicit Layout(const PlotPage& page);

  // Size of the page, px.
  Point size() const { return {static_cast<double>(page_.width_px), height_}; }
  void paint(Painter& painter) const;

 private:
  // A plot, the y axis of the plot, and the plot's position on the page.
  struct Placed {
    const LinePlot* plot;
    Axis y;
    Rectangle frame = {};
    Legend legend = {};
    std::vector<std::string> caption = {};
    double caption_top = 0;  // px
    bool empty = false;      // true: no point can be drawn
  };

  Point place(const Placed& placed, double x, double y) const;
  bool shows(double x, double y) const;
  void choose_axes();
  void place_plots();
  void paint_plot(Painter& painter, const Placed& placed, bool last) const;
  void paint_spans(Painter& painter, const Placed& placed) const;
  void paint_grid(Painter& painter, const Placed& placed) const;
  void paint_ticks(Painter& painter, const Placed& placed, bool last) const;
  void paint_line(Painter& painter, const Placed& placed, const HorizontalLine& line) const;
  void paint_series(Painter& painter, const Placed& placed, const Series& series) const;

  const PlotPage& page_;
  Axis x_;
  std::vector<Placed> plots_;
  double height_ = 0;
};

}  // namespace kaz::plot
