// Plots: any points make a picture that is well-formed and stays within its frame.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "shared/base/xml_testing.hpp"
#include "shared/plot/svg.h"

namespace kaz::plot {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
using Points = std::vector<std::pair<double, double>>;
using Style = Series::Style;

Series series_of(const std::string& label, const Points& points, Style style = Style::line) {
  Series series{label, kBlue, {}, {}, 1.6, style};
  for (const auto& [x, y] : points) {
    series.x.push_back(x);
    series.y.push_back(y);
  }
  return series;
}

PlotPage page_of(const Points& points, bool logarithmic = false, Style style = Style::line) {
  PlotPage page;
  page.x_label = "x, s";
  page.x_logarithmic = logarithmic;
  page.width_px = 560;
  page.plot_height_px = 300;
  LinePlot plot;
  plot.title = "Title";
  plot.y_label = "y, V";
  plot.caption = "A caption.";
  plot.series = {series_of("one", points, style)};
  page.plots = {plot};
  return page;
}

std::vector<Points> lines(const tinyxml2::XMLNode& root) {
  std::vector<Points> all;
  for (const auto* line : elements(root, "polyline")) {
    std::istringstream points(line->Attribute("points"));
    double x = 0, y = 0;
    char comma = 0;
    all.emplace_back();
    while (points >> x >> comma >> y) all.back().emplace_back(x, y);
  }
  return all;
}

// Lines of the series that page_of() draws; grid, frame and ticks are of other colors.
std::vector<Points> curves(const std::string& svg) {
  tinyxml2::XMLDocument document;
  parse_xml(svg, document);
  const auto all = lines(document);
  const auto shapes = elements(document, "polyline");
  std::vector<Points> blue;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool in_legend = all[i].size() == 2 && shapes[i]->DoubleAttribute("stroke-width") == 2.2;
    if (shapes[i]->Attribute("stroke", "#1f6bbf") && !in_legend) blue.push_back(all[i]);
  }
  return blue;
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
  for (const Points& line : lines(*root)) {
    EXPECT_GE(line.size(), 2u);
    for (const auto& [x, y] : line) inside(x, y);
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
    for (const auto style : {Style::line, Style::points, Style::dashed}) {
      for (const bool logarithmic : {false, true}) {
        for (const bool limited : {false, true}) {
          SCOPED_TRACE(std::string(name) + (logarithmic ? ", logarithmic" : "") +
                       (limited ? ", limited" : ""));
          PlotPage page = page_of(points, logarithmic, style);
          page.plots[0].spans = {{-1, 2, kGrey, "span"}, {1, kInfinite, kGrey, "open"}};
          page.plots[0].lines = {{3, kGreen, "limit"}, {std::nan(""), kGreen, "none"}};
          if (limited) page.plots[0].y_min = -2;
          if (limited) page.plots[0].y_max = 2;
          expect_valid(plot_svg(page));
          page.plots[0].spans.clear();
          page.plots[0].lines.clear();
          expect_valid(plot_svg(page));
        }
      }
    }
  }
}

TEST(PlotSvg, SaysThatThereIsNothing) {
  EXPECT_NE(plot_svg(page_of({})).find("no data"), std::string::npos);
  EXPECT_NE(plot_svg(page_of({{0, 1}}, true)).find("no data"), std::string::npos);
  EXPECT_EQ(plot_svg(page_of({{0, 1}})).find("no data"), std::string::npos);
  PlotPage none;
  none.plots.resize(1);
  expect_valid(plot_svg(page_of({})));
  EXPECT_NE(plot_svg(none).find("no data"), std::string::npos);
  EXPECT_EQ(plot_svg({}).find("no data"), std::string::npos) << "no plot at all";
}

TEST(PlotSvg, APointBetweenGapsIsSeen) {
  const std::string svg = plot_svg(page_of({{0, 1}, {1, 1}, {2, std::nan("")}, {3, 2}}));
  tinyxml2::XMLDocument document;
  parse_xml(svg, document);
  ASSERT_EQ(elements(document, "path").size(), 1u);
  const std::string dot = elements(document, "path")[0]->Attribute("d");
  EXPECT_EQ(std::count(dot.begin(), dot.end(), 'M'), 1);
  EXPECT_EQ(curves(svg).size(), 1u);
}

TEST(PlotSvg, StylesTitleLegendAndCaption) {
  PlotPage page = page_of({{0, 1}, {1, 2}});
  const std::string plain = plot_svg(page);
  EXPECT_EQ(plain.find("stroke-dasharray"), std::string::npos);
  LinePlot& plot = page.plots[0];
  plot.title = "Torque & volts";
  plot.series.push_back(series_of("line \"1\"", {{0, 1}, {1, 1}}, Style::dashed));
  plot.series.push_back(series_of("cloud", {{0, 1}, {1, 1}, {0, 1}}, Style::points));
  plot.series.push_back(series_of("", {{0, 1}, {1, 1}}));
  const std::string svg = plot_svg(page);
  expect_valid(svg);
  for (const char* text :
       {"<title>Torque &amp; volts</title>", ">Torque &amp; volts</text>", "stroke-dasharray",
        ">line &quot;1&quot;</text>", ">cloud</text>", ">A caption.</text>", ">x, s</text>"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
  // The cloud, whose third point is drawn already, and its mark in the legend.
  tinyxml2::XMLDocument document;
  parse_xml(svg, document);
  const auto dots = elements(document, "path");
  ASSERT_EQ(dots.size(), 2u);
  const std::string cloud = dots[0]->Attribute("d");
  EXPECT_EQ(std::count(cloud.begin(), cloud.end(), 'M'), 2);
  page.title = "Page";
  EXPECT_NE(plot_svg(page).find("<title>Page</title>"), std::string::npos);
}

TEST(PlotSvg, AxesWithACommonFactorNameIt) {
  const std::string svg = plot_svg(page_of({{0, 0}, {4e6, 2e-5}}));
  EXPECT_NE(svg.find(">x, s (× 10⁶)</text>"), std::string::npos);
  EXPECT_NE(svg.find(">y, V (× 10⁻⁶)</text>"), std::string::npos);
}

double height(const PlotPage& page) {
  tinyxml2::XMLDocument document;
  parse_xml(plot_svg(page), document);
  return document.RootElement()->DoubleAttribute("height");
}

TEST(PlotSvg, ALongLegendAndALongCaptionTakeMoreLines) {
  PlotPage page = page_of({{0, 1}, {1, 2}});
  LinePlot& plot = page.plots[0];
  const double before = height(page);
  plot.series.push_back(series_of("short", {{0, 1}, {1, 2}}));
  EXPECT_EQ(height(page), before) << "the title's line has room";
  for (int i = 0; i < 18; ++i) {
    plot.series.push_back(series_of("a joint with a long name", {{0, i}, {1, 2}}));
  }
  const double with_legend = height(page);
  EXPECT_GT(with_legend, before + 50);
  for (int i = 0; i < 60; ++i) plot.caption += " and on";
  EXPECT_GT(height(page), with_legend + 50);
  expect_valid(plot_svg(page));
  // Entries start within the page.
  tinyxml2::XMLDocument document;
  parse_xml(plot_svg(page), document);
  for (const auto* text : elements(document, "text")) {
    if (std::string(text->GetText()) == "a joint with a long name") {
      EXPECT_LT(text->DoubleAttribute("x"), 560 - 100);
    }
  }
}

TEST(PlotSvg, PlotsStandOneAboveTheOther) {
  PlotPage page = page_of({{0, 1}, {1, 2}});
  const double one = height(page);
  page.plots.push_back(page.plots[0]);
  const std::string svg = plot_svg(page);
  expect_valid(svg);
  EXPECT_GT(height(page), one + 300);
  const std::vector<Points> both = curves(svg);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[0][0].first, both[1][0].first);
  EXPECT_GT(both[1][0].second, both[0][0].second + 300);
  // The label of x stands once.
  EXPECT_EQ(svg.find(">x, s</text>"), svg.rfind(">x, s</text>"));
}

TEST(PlotSvg, LimitsOfYCutTheCurve) {
  PlotPage page = page_of({{0, 0}, {1, 100}, {2, 0}, {3, 0}, {4, -1e300}, {5, 0}});
  page.plots[0].y_min = 0;
  page.plots[0].y_max = 10;
  const std::string svg = plot_svg(page);
  expect_valid(svg);
  const std::vector<Points> pieces = curves(svg);
  ASSERT_GE(pieces.size(), 3u);
  // The frame is the second rectangle, after the page.
  tinyxml2::XMLDocument document;
  parse_xml(svg, document);
  const auto* frame = elements(document, "rect").at(1);
  const double top = frame->DoubleAttribute("y"), bottom = top + frame->DoubleAttribute("height");
  double highest = bottom;
  for (const Points& piece : pieces) {
    for (const auto& [x, y] : piece) {
      EXPECT_GE(y, top);
      EXPECT_LE(y, bottom);
      highest = std::min(highest, y);
    }
  }
  EXPECT_EQ(highest, top);
}

TEST(PlotSvg, AHundredThousandPointsAreASmallPictureOfTheSameShape) {
  Points points;
  for (int i = 0; i < 100000; ++i) points.emplace_back(i, i == 54321 ? 100 : std::sin(0.01 * i));
  for (const auto style : {Style::line, Style::points}) {
    const std::string svg = plot_svg(page_of(points, false, style));
    EXPECT_LT(svg.size(), style == Style::line ? 60000u : 200000u);
    expect_valid(svg);
  }
  // The one that stands out is still there: the highest place that the line takes is far above.
  const std::vector<Points> drawn = curves(plot_svg(page_of(points)));
  ASSERT_EQ(drawn.size(), 1u);
  const auto [highest, lowest] =
      std::minmax_element(drawn[0].begin(), drawn[0].end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; });
  EXPECT_GT(lowest->second - highest->second, 150);
}

}  // namespace
}  // namespace kaz::plot
