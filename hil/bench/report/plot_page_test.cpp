// Plots of the bench on the page of the plotter.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "hil/bench/report/report_testing.h"
#include "shared/base/xml_testing.hpp"
#include "shared/plot/svg.h"

namespace kaz::hil {
namespace {

std::string svg_of(const Plot& plot) {
  return plot::plot_svg(plot_page(plot));
}

TEST(PlotPage, HasAllThatThePlotHas) {
  const BenchReport report = test_report();
  for (const Plot& plot : report.plots) {
    const plot::PlotPage page = plot_page(plot);
    ASSERT_EQ(page.plots.size(), 1u);
    const plot::LinePlot& shown = page.plots[0];
    EXPECT_EQ(shown.title, plot.title);
    EXPECT_EQ(page.x_label, plot.x_label);
    EXPECT_EQ(shown.y_label, plot.y_label);
    EXPECT_EQ(shown.caption, plot.caption);
    EXPECT_EQ(page.x_logarithmic, plot.x_logarithmic);
    ASSERT_EQ(shown.series.size(), plot.series.size());
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
      EXPECT_EQ(shown.series[i].style, plot.series[i].style);
      EXPECT_EQ(shown.series[i].x.size(), plot.series[i].points.size());
      EXPECT_EQ(shown.series[i].x[0], plot.series[i].points[0].first);
      EXPECT_EQ(shown.series[i].y[0], plot.series[i].points[0].second);
    }
  }
}

TEST(PlotPage, StylesLegendAndCaption) {
  const BenchReport report = test_report();
  const std::string three = svg_of(report.plots[0]), one = svg_of(report.plots[1]);
  for (const std::string* svg : {&three, &one}) {
    tinyxml2::XMLDocument document;
    parse_xml(*svg, document);
    EXPECT_EQ(elements(document, "title").size(), 1u);
  }
  EXPECT_NE(three.find("stroke-dasharray"), std::string::npos);
  EXPECT_NE(three.find("<title>Torque &amp; volts</title>"), std::string::npos);
  EXPECT_NE(three.find(">line &quot;1&quot;</text>"), std::string::npos);
  EXPECT_NE(three.find(">Torque &amp; volts</text>"), std::string::npos);
  EXPECT_NE(three.find(">A line.</text>"), std::string::npos);
  EXPECT_NE(three.find(">motor voltage, V</text>"), std::string::npos);
  EXPECT_EQ(one.find("stroke-dasharray"), std::string::npos);
  Plot named = report.plots[1];
  named.series[0].name = "alone";
  EXPECT_EQ(svg_of(named).find(">alone</text>"), std::string::npos) << "one series has no legend";
}

TEST(PlotPage, WithoutDataIsDrawnNevertheless) {
  EXPECT_NE(svg_of(Plot{}).find("no data"), std::string::npos);
}

}  // namespace
}  // namespace kaz::hil
