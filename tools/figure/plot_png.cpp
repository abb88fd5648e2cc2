// Plots as pixels, by Cairo.
// SPDX-License-Identifier: Apache-2.0
#include "tools/figure/painter.h"
#include "tools/figure/surface.h"

namespace kaz::figure {

namespace {

class CairoPainter final : public Painter {
 public:
  explicit CairoPainter(cairo_t* c) : c_(c) {
    cairo_set_line_join(c_, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(c_, CAIRO_LINE_CAP_BUTT);
  }

  void rectangle(Point corner, double width, double height, Color fill, double alpha) override {
    cairo_rectangle(c_, corner.x, corner.y, width, height);
    set_color(c_, fill, alpha);
    cairo_fill(c_);
  }

  void line(std::span<const Point> points, Color color, double width_px, bool dashed) override {
    cairo_new_path(c_);  // text leaves a current point behind
    for (const Point& p : points) cairo_line_to(c_, p.x, p.y);
    const double dash[] = {6, 4};
    cairo_set_dash(c_, dash, dashed ? 2 : 0, 0);
    set_color(c_, color);
    cairo_set_line_width(c_, width_px);
    cairo_stroke(c_);
  }

  void text(Point baseline, const std::string& text, const TextStyle& style) override {
    set_font(c_, style.size_px, style.bold);
    const double width = text_width(text, style.size_px, style.bold);
    const double back = style.anchor == Anchor::start    ? 0
                        : style.anchor == Anchor::middle ? 0.5
                                                         : 1;
    cairo_save(c_);
    cairo_translate(c_, baseline.x, baseline.y);
    if (style.upwards) cairo_rotate(c_, -0.5 * 3.14159265358979323846);
    cairo_move_to(c_, -back * width, 0);
    set_color(c_, style.color);
    cairo_show_text(c_, text.c_str());
    cairo_restore(c_);
  }

  void clip(Point corner, double width, double height) override {
    cairo_save(c_);
    cairo_rectangle(c_, corner.x, corner.y, width, height);
    cairo_clip(c_);
  }
  void unclip() override { cairo_restore(c_); }

 private:
  cairo_t* c_;
};

}  // namespace

double text_width(const std::string& text, double size_px, bool bold) {
  const Surface surface = blank_surface(1, 1, kWhite);
  const Context c(cairo_create(surface.get()));
  set_font(c.get(), size_px, bold);
  cairo_text_extents_t extents{};
  cairo_text_extents(c.get(), text.c_str(), &extents);
  return extents.x_advance;
}

Result<void> write_plot_png(const std::string& path, const PlotPage& page) {
  constexpr int kScale = 2;  // sharp on dense screens
  const Point size = page_size(page);
  const Surface surface =
      blank_surface(kScale * static_cast<int>(size.x), kScale * static_cast<int>(size.y), kWhite);
  const Context c(cairo_create(surface.get()));
  cairo_scale(c.get(), kScale, kScale);
  CairoPainter painter(c.get());
  paint(painter, page);
  return write_surface_png(path, surface.get());
}

}  // namespace kaz::figure
