// Plots: any points make a picture that is well-formed and stays within its frame.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "hil/bench/report/plot_axis.h"
#include "hil/bench/report/report_testing.h"
#include "shared/base/xml_testing.hpp"

namespace kaz::hil {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
using Points = std::vector<std::pair<double, double>>;

Plot plot_of(Points points, bool logarithmic = false, Series::Style style = Series::Style::line) {
  return {"id",
          "link",
          "Title",
          "x, s",
          "y, V",
          logarithmic,
          {{"one", style, std::move(points)}},
          "A caption."};
}

// All numbers that place something are finite and within the picture.
void expect_valid(const std::string& svg) {
  tinyxml2::XMLDocument document;
  parse_xml(svg, document);
  const auto* root = document.RootElement();
  ASSERT_TRUE(root);
  const double width = root->DoubleAttribute("width"), height = root->DoubleAttribute("height");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  const auto inside = [&](double x, double y) {
    EXPECT_TRUE(x >= 0 && x <= width && y >= 0 && y <= height) << x << ", " << y;
  };
  for (const char* name : {"text", "rect"}) {
    for (const auto* one : elements(*root, name)) {
      inside(one->DoubleAttribute("x"), one->DoubleAttribute("y"));
    }
  }
  for (const auto* dot : elements(*root, "circle")) {
    inside(dot->DoubleAttribute("cx"), dot->DoubleAttribute("cy"));
  }
  for (const auto* line : elements(*root, "polyline")) {
    std::istringstream points(line->Attribute("points"));
    double x = 0, y = 0;
    char comma = 0;
    while (points >> x >> comma >> y) inside(x, y);
  }
  for (const auto* dots : elements(*root, "path")) {
    std::string places = dots->Attribute("d");  // "M1.0,2.0h0M3.0,4.0h0"
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i] == 'h') places[i + 1] = ' ';
      if (places[i] == 'M' || places[i] == 'h' || places[i] == ',') places[i] = ' ';
    }
    std::istringstream points(places);
    double x = 0, y = 0;
    int count = 0;
    for (; points >> x >> y; ++count) inside(x, y);
    EXPECT_GT(count, 0);
  }
  const auto labels = elements(*root, "text");
  EXPECT_GE(labels.size(), 3u + 4u) << "at least two ticks on each axis";
  EXPECT_LT(labels.size(), 60u);
}

TEST(PlotSvg, AnyPointsMakeAPicture) {
  const std::pair<const char*, Points> cases[] = {
      {"empty", {}},
      {"one point", {{1, 2}}},
      {"constant", {{0, 5}, {1, 5}, {2, 5}}},
      {"zero", {{0, 0}, {0, 0}}},
      {"upright", {{3, 0}, {3, 10}}},
      {"gaps", {{0, 1}, {1, std::nan("")}, {2, 3}, {std::nan(""), 4}, {4, kInfinite}, {5, 1}}},
      {"nothing but gaps", {{std::nan(""), std::nan("")}, {0, -kInfinite}}},
      {"huge", {{0, -1e308}, {1e308, 1e308}}},
      {"tiny", {{1e-300, 1e-305}, {3e-300, 2e-305}}},
      {"smallest", {{5e-324, 5e-324}, {1e-323, 1e-323}}},
      {"far away", {{1e9, 1e6}, {1e9 + 1, 1e6 + 1e-3}}},
      {"negative", {{-5, -3}, {-4, -9}}},
      {"mixed sizes", {{1e-300, 1e-300}, {1e300, 1e300}}},
  };
  for (const auto& [name, points] : cases) {
    for (const auto style : {Series::Style::line, Series::Style::points, Series::Style::dashed}) {
      for (const bool logarithmic : {false, true}) {
        SCOPED_TRACE(std::string(name) + (logarithmic ? ", logarithmic" : ""));
        expect_valid(plot_svg(plot_of(points, logarithmic, style)));
      }
    }
  }
}

TEST(PlotSvg, SaysThatThereIsNothing) {
  EXPECT_NE(plot_svg(plot_of({})).find("no data"), std::string::npos);
  EXPECT_NE(plot_svg(plot_of({{0, 1}}, true)).find("no data"), std::string::npos);
  EXPECT_EQ(plot_svg(plot_of({{0, 1}})).find("no data"), std::string::npos);
  Plot none;
  expect_valid(plot_svg(plot_of({})));
  EXPECT_NE(plot_svg(none).find("no data"), std::string::npos);
}

TEST(PlotSvg, APointBetweenGapsIsSeen) {
  tinyxml2::XMLDocument document;
  parse_xml(plot_svg(plot_of({{0, 1}, {1, 1}, {2, std::nan("")}, {3, 2}})), document);
  EXPECT_EQ(elements(document, "circle").size(), 1u);
  EXPECT_EQ(elements(document, "polyline").size(), 1u);
}

TEST(PlotSvg, StylesLegendAndCaption) {
  const BenchReport report = test_report();
  const std::string three = plot_svg(report.plots[0]), one = plot_svg(report.plots[1]);
  expect_valid(three);
  EXPECT_NE(three.find("stroke-dasharray"), std::string::npos);
  EXPECT_NE(three.find(">line &quot;1&quot;</text>"), std::string::npos);
  EXPECT_NE(three.find(">Torque &amp; volts</text>"), std::string::npos);
  EXPECT_NE(three.find(">A line.</text>"), std::string::npos);
  EXPECT_NE(three.find(">motor voltage, V</text>"), std::string::npos);
  EXPECT_EQ(one.find("stroke-dasharray"), std::string::npos);
  Plot named = report.plots[1];
  named.series[0].name = "alone";
  EXPECT_EQ(plot_svg(named).find(">alone</text>"), std::string::npos) << "one series has no legend";
}

TEST(PlotSvg, ALongLegendAndALongCaptionTakeMoreLines) {
  Plot plot = plot_of({{0, 1}, {1, 2}});
  const auto height = [](const Plot& of) {
    tinyxml2::XMLDocument document;
    parse_xml(plot_svg(of), document);
    return document.RootElement()->DoubleAttribute("height");
  };
  const double before = height(plot);
  for (int i = 0; i < 18; ++i) {
    plot.series.push_back({"a joint with a long name", Series::Style::line, {{0, i}, {1, 2}}});
  }
  for (int i = 0; i < 60; ++i) plot.caption += " and on";
  EXPECT_GT(height(plot), before + 100);
  expect_valid(plot_svg(plot));
}

TEST(PlotSvg, AHundredThousandPointsAreASmallPictureOfTheSameShape) {
  Points points;
  for (int i = 0; i < 100000; ++i) points.emplace_back(i, i == 54321 ? 100 : std::sin(0.01 * i));
  for (const auto style : {Series::Style::line, Series::Style::points}) {
    const std::string svg = plot_svg(plot_of(points, false, style));
    EXPECT_LT(svg.size(), style == Series::Style::line ? 60000u : 200000u);
    expect_valid(svg);
  }
  // The one that stands out is still there: the highest place that the line takes is far above.
  tinyxml2::XMLDocument document;
  parse_xml(plot_svg(plot_of(points)), document);
  std::istringstream line(elements(document, "polyline")[0]->Attribute("points"));
  double x = 0, y = 0, highest = 1e9, lowest = 0;
  char comma = 0;
  while (line >> x >> comma >> y) {
    highest = std::min(highest, y);
    lowest = std::max(lowest, y);
  }
  EXPECT_GT(lowest - highest, 150);
}

std::vector<std::string> labels(const PlotAxis& axis) {
  std::vector<std::string> all;
  for (const auto& tick : axis.ticks()) {
    if (!tick.label.empty()) all.push_back(tick.label);
  }
  return all;
}
using Labels = std::vector<std::string>;

TEST(PlotAxis, RoundNumbersAndCommonFactors) {
  EXPECT_EQ(labels(PlotAxis::linear(0, 1, 5, true)),
            (Labels{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  const PlotAxis large = PlotAxis::linear(0, 4e6, 4, true);
  EXPECT_EQ(labels(large), (Labels{"0", "1", "2", "3", "4"}));
  EXPECT_EQ(large.factor(), "10⁶");
  const PlotAxis small = PlotAxis::linear(0, 2e-5, 2, true);
  EXPECT_EQ(labels(small), (Labels{"0", "10", "20"}));
  EXPECT_EQ(small.factor(), "10⁻⁶");
  EXPECT_DOUBLE_EQ(small.at(1e-5), 0.5);
}

TEST(PlotAxis, LogarithmicOnesHaveTheirTicksAtRoundNumbers) {
  EXPECT_EQ(labels(PlotAxis::logarithmic(0.1, 20)),
            (Labels{"0.1", "0.2", "0.5", "1", "2", "5", "10", "20"}));
  EXPECT_EQ(labels(PlotAxis::logarithmic(1, 1e6)),
            (Labels{"1", "10", "100", "1000", "10000", "10⁵", "10⁶"}));
  EXPECT_GE(labels(PlotAxis::logarithmic(3, 4)).size(), 2u);
  EXPECT_LE(labels(PlotAxis::logarithmic(1e-300, 1e300)).size(), 10u);
  const PlotAxis axis = PlotAxis::logarithmic(1, 100);
  EXPECT_NEAR(axis.at(10), 0.5, 1e-12);
}

}  // namespace
}  // namespace kaz::hil
