// Plots as SVG 1.1, with text as text (Cairo's own SVG would turn it into outlines).
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdio>

#include "shared/base/xml_text.hpp"
#include "tools/figure/painter.h"
#include "tools/figure/surface.h"

namespace kaz::figure {

namespace {

std::string number(double v) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f", v);
  return text.data();
}

std::string color_text(Color c) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", static_cast<int>(std::lround(c.r * 255)),
                static_cast<int>(std::lround(c.g * 255)), static_cast<int>(std::lround(c.b * 255)));
  return text.data();
}

class SvgPainter final : public Painter {
 public:
  explicit SvgPainter(Point size) {
    const std::string w = number(size.x), h = number(size.y);
    svg_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h +
           "\" viewBox=\"0 0 " + w + " " + h + "\" font-family=\"" + kFont + ", sans-serif\">\n";
  }

  void rectangle(Point corner, double width, double height, Color fill, double alpha) override {
    svg_ += "<rect x=\"" + number(corner.x) + "\" y=\"" + number(corner.y) + "\" width=\"" +
            number(width) + "\" height=\"" + number(height) + "\" fill=\"" + color_text(fill) +
            "\" fill-opacity=\"" + number(alpha) + "\"/>\n";
  }

  void line(std::span<const Point> points, Color color, double width_px, bool dashed) override {
    svg_ += "<polyline fill=\"none\" stroke=\"" + color_text(color) + "\" stroke-width=\"" +
            number(width_px) + "\" stroke-linejoin=\"round\"" +
            (dashed ? " stroke-dasharray=\"6 4\"" : "") + " points=\"";
    for (const Point& p : points) svg_ += number(p.x) + "," + number(p.y) + " ";
    svg_ += "\"/>\n";
  }

  void text(Point at, const std::string& text, const TextStyle& style) override {
    constexpr std::array<const char*, 3> kAnchors{"start", "middle", "end"};
    const std::string x = number(at.x), y = number(at.y);
    svg_ += "<text x=\"" + x + "\" y=\"" + y + "\" font-size=\"" + number(style.size_px) +
            "\" fill=\"" + color_text(style.color) + "\" text-anchor=\"" +
            kAnchors[static_cast<std::size_t>(style.anchor)] + "\"" +
            (style.bold ? " font-weight=\"bold\"" : "") +
            (style.upwards ? " transform=\"rotate(-90 " + x + " " + y + ")\"" : "") + ">" +
            xml_text(text) + "</text>\n";
  }

  void clip(Point corner, double width, double height) override {
    std::string id = "c";
    id += std::to_string(++clips_);
    svg_ += "<clipPath id=\"" + id + "\"><rect x=\"" + number(corner.x) + "\" y=\"" +
            number(corner.y) + "\" width=\"" + number(width) + "\" height=\"" + number(height) +
            "\"/></clipPath>\n<g clip-path=\"url(#" + id + ")\">\n";
  }
  void unclip() override { svg_ += "</g>\n"; }

  std::string finish() { return svg_ + "</svg>\n"; }

 private:
  std::string svg_;
  int clips_ = 0;
};

}  // namespace

Result<void> write_plot_svg(const std::string& path, const PlotPage& page) {
  SvgPainter painter(page_size(page));
  paint(painter, page);
  const std::string svg = painter.finish();
  return write_file(path, {reinterpret_cast<const std::uint8_t*>(svg.data()), svg.size()});
}

}  // namespace kaz::figure
