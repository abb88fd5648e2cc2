// Writes the shapes of a page as elements of SVG.
// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/svg.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "shared/base/xml_text.hpp"
#include "shared/plot/layout.h"

namespace kaz::plot {
namespace {

// At most two decimals.
std::string number(double v) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.2f", v);
  std::string trimmed = text.data();
  trimmed.erase(trimmed.find_last_not_of('0') + 1);
  if (trimmed.back() == '.') trimmed.pop_back();
  return trimmed == "-0" ? "0" : trimmed;
}

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + value + "\"";
}

std::string attribute(const char* name, double value) {
  return attribute(name, number(value));
}

// Nothing for opaque shapes.
std::string opacity(const char* name, double alpha) {
  return alpha < 1 ? attribute(name, alpha) : std::string();
}

std::string color_text(Color c) {
  std::array<char, 16> text{};
  const auto byte = [](double share) {
    return static_cast<unsigned>(std::lround(share * 255)) & 255;
  };
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", byte(c.r), byte(c.g), byte(c.b));
  return text.data();
}

class SvgPainter final : public Painter {
 public:
  SvgPainter(Point size, const std::string& title) {
    svg_ = "<svg xmlns=\"http://www.w3.org/2000/svg\"" + attribute("width", size.x) +
           attribute("height", size.y) +
           attribute("viewBox", "0 0 " + number(size.x) + " " + number(size.y)) +
           " role=\"img\" font-family=\"system-ui, sans-serif\">\n<title>" + xml_text(title) +
           "</title>\n";
  }

  void rectangle(const Rectangle& area, Color fill, double alpha) override {
    svg_ += "<rect" + attribute("x", area.left) + attribute("y", area.top) +
            attribute("width", area.width) + attribute("height", area.height) +
            attribute("fill", color_text(fill)) + opacity("fill-opacity", alpha) + "/>\n";
  }

  void line(std::span<const Point> points, Color color, double width_px, bool dashed) override {
    svg_ += "<polyline fill=\"none\"" + attribute("stroke", color_text(color)) +
            attribute("stroke-width", width_px) + " stroke-linejoin=\"round\"" +
            (dashed ? attribute("stroke-dasharray", number(kDashPx) + " " + number(kDashGapPx))
                    : std::string()) +
            " points=\"";
    const char* between = "";
    for (const Point& p : points) {
      svg_ += between;
      svg_ += number(p.x) + "," + number(p.y);
      between = " ";
    }
    svg_ += "\"/>\n";
  }

  // As strokes of zero length with round caps, which are shorter than circles.
  void dots(std::span<const Point> centers, Color color, double diameter_px,
            double alpha) override {
    svg_ += "<path fill=\"none\"" + attribute("stroke", color_text(color)) +
            attribute("stroke-width", diameter_px) + " stroke-linecap=\"round\"" +
            opacity("stroke-opacity", alpha) + " d=\"";
    for (const Point& p : centers) {
      svg_ += 'M';
      svg_ += number(p.x) + "," + number(p.y) + "h0";
    }
    svg_ += "\"/>\n";
  }

  void text(Point at, const std::string& text, const TextStyle& style) override {
    if (text.empty()) return;
    constexpr std::array<const char*, 3> kAnchors{"start", "middle", "end"};
    svg_ += "<text" + attribute("x", at.x) + attribute("y", at.y) +
            attribute("font-size", style.size_px) + attribute("fill", color_text(style.color)) +
            attribute("text-anchor", kAnchors[static_cast<std::size_t>(style.anchor)]) +
            (style.bold ? " font-weight=\"600\"" : "") +
            (style.upwards
                 ? attribute("transform", "rotate(-90 " + number(at.x) + " " + number(at.y) + ")")
                 : std::string()) +
            ">" + xml_text(text) + "</text>\n";
  }

  std::string finish() { return std::move(svg_) + "</svg>\n"; }

 private:
  std::string svg_;
};

}  // namespace

std::string plot_svg(const PlotPage& page) {
  const std::string& title =
      page.title.empty() && !page.plots.empty() ? page.plots[0].title : page.title;
  const Layout layout(page);
  SvgPainter painter(layout.size(), title);
  layout.paint(painter);
  return painter.finish();
}

}  // namespace kaz::plot
