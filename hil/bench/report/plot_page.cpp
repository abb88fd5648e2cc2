// A plot of the bench as a page of the plotter.
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "hil/bench/report.h"

namespace kaz::hil {

plot::PlotPage plot_page(const Plot& plot) {
  constexpr std::array kColors = {plot::kBlue,   plot::kRed,    plot::kGreen,
                                  plot::kOrange, plot::kPurple, plot::kGrey};
  plot::LinePlot page_plot;
  page_plot.title = plot.title;
  page_plot.y_label = plot.y_label;
  page_plot.caption = plot.caption;
  for (const Series& series : plot.series) {
    plot::Series curve;
    if (plot.series.size() > 1) curve.label = series.name;  // one alone needs no legend
    curve.color = kColors[page_plot.series.size() % kColors.size()];
    for (const auto& [x, y] : series.points) {
      curve.x.push_back(x);
      curve.y.push_back(y);
    }
    curve.width_px = 1.6;
    curve.style = series.style;
    page_plot.series.push_back(std::move(curve));
  }
  plot::PlotPage page;
  page.x_label = plot.x_label;
  page.plots.push_back(std::move(page_plot));
  page.width_px = 560;
  page.plot_height_px = 300;
  page.x_logarithmic = plot.x_logarithmic;
  return page;
}

}  // namespace kaz::hil
