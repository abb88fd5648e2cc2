// Plots as files: PNG by Cairo, SVG.
// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/layout.h"
#include "shared/plot/svg.h"
#include "tools/drawing/figure.h"
#include "tools/drawing/surface.h"

namespace kaz::figure {

namespace {

using plot::Point;

class CairoPainter final : public plot::Painter {
 public:
  explicit CairoPainter(cairo_t* c) : c_(c) {
    cairo_set_line_join(c_, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(c_, CAIRO_LINE_CAP_BUTT);
  }

  void rectangle(const plot::Rectangle& area, Color fill, double alpha) override {
    cairo_rectangle(c_, area.left, area.top, area.width, area.height);
    set_color(c_, fill, alpha);
    cairo_fill(c_);
  }

  void line(std::span<const Point> points, Color color, double width_px, bool dashed) override {
    cairo_new_path(c_);  // text leaves a current point behind
    for (const Point& p : points) cairo_line_to(c_, p.x, p.y);
    const double dash[] = {plot::kDashPx, plot::kDashGapPx};
    cairo_set_dash(c_, dash, dashed ? 2 : 0, 0);
    set_color(c_, color);
    cairo_set_line_width(c_, width_px);
    cairo_stroke(c_);
  }

  void dots(std::span<const Point> centers, Color color, double diameter_px,
            double alpha) override {
    cairo_new_path(c_);
    for (const Point& p : centers) {
      cairo_move_to(c_, p.x, p.y);
      cairo_close_path(c_);  // a stroke of zero length, which round caps make a disc
    }
    cairo_save(c_);
    cairo_set_line_cap(c_, CAIRO_LINE_CAP_ROUND);
    cairo_set_dash(c_, nullptr, 0, 0);
    set_color(c_, color, alpha);
    cairo_set_line_width(c_, diameter_px);
    cairo_stroke(c_);
    cairo_restore(c_);
  }

  void text(Point baseline, const std::string& text, const plot::TextStyle& style) override {
    set_font(c_, style.size_px, style.bold);
    cairo_text_extents_t extents{};
    cairo_text_extents(c_, text.c_str(), &extents);
    const double back = style.anchor == plot::Anchor::start    ? 0
                        : style.anchor == plot::Anchor::middle ? 0.5
                                                               : 1;
    cairo_save(c_);
    cairo_translate(c_, baseline.x, baseline.y);
    if (style.upwards) cairo_rotate(c_, -0.5 * 3.14159265358979323846);
    cairo_move_to(c_, -back * extents.x_advance, 0);
    set_color(c_, style.color);
    cairo_show_text(c_, text.c_str());
    cairo_restore(c_);
  }

 private:
  cairo_t* c_;
};

Surface draw(const PlotPage& page) {
  constexpr int kScale = 2;
  const plot::Layout layout(page);
  const Point size = layout.size();
  Surface surface =
      blank_surface(kScale * static_cast<int>(size.x), kScale * static_cast<int>(size.y), kWhite);
  const Context c(cairo_create(surface.get()));
  cairo_scale(c.get(), kScale, kScale);
  CairoPainter painter(c.get());
  layout.paint(painter);
  return surface;
}

}  // namespace

Result<void> write_plot_png(const std::string& path, const PlotPage& page) {
  return write_surface_png(path, draw(page).get());
}

Result<void> write_plot_svg(const std::string& path, const PlotPage& page) {
  const std::string svg = plot::plot_svg(page);
  return write_file(path, {reinterpret_cast<const std::uint8_t*>(svg.data()), svg.size()});
}

}  // namespace kaz::figure
