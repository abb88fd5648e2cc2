// Overlays, masks, and panels with captions.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tools/drawing/surface.h"

namespace kaz::figure {

namespace {

constexpr double kPi = 3.14159265358979323846;

// Draws with Cairo into an image. Our pixel centres are at integers, Cairo's at halves.
template <class Draw>
void draw_into(Image& image, Draw draw) {
  if (image.width <= 0 || image.height <= 0) return;
  const Surface surface = surface_from(image);
  {
    const Context c(cairo_create(surface.get()));
    cairo_translate(c.get(), 0.5, 0.5);
    draw(c.get());
  }
  image = image_from(surface.get());
}

// A dark edge around the stroke keeps it visible on any ground.
void stroke_with_edge(cairo_t* c, Color color, double width_px) {
  cairo_set_line_cap(c, CAIRO_LINE_CAP_ROUND);
  set_color(c, kBlack, 0.45);
  cairo_set_line_width(c, width_px + 1.6);
  cairo_stroke_preserve(c);
  set_color(c, color);
  cairo_set_line_width(c, width_px);
  cairo_stroke(c);
}

}  // namespace

Image mask_picture(const vision::Mask& mask) {
  Image image{mask.width, mask.height, {}};
  image.rgb.reserve(mask.pixels.size() * 3);
  for (const std::uint8_t m : mask.pixels) image.rgb.insert(image.rgb.end(), 3, m);
  return image;
}

Image mask_picture(const vision::Mask& mask, const Image& picture) {
  Image image = picture;
  for (std::size_t i = 0; i < mask.pixels.size() && 3 * i + 2 < image.rgb.size(); ++i) {
    if (mask.pixels[i] != 0) continue;
    std::uint8_t* p = &image.rgb[3 * i];
    const auto y = static_cast<std::uint8_t>(0.35 * vision::yiq_from_rgb(p[0], p[1], p[2]).y);
    std::fill_n(p, 3, y);
  }
  return image;
}

void draw_circle(Image& image, double u, double v, double radius_px, Color color, double width_px) {
  draw_into(image, [&](cairo_t* c) {
    cairo_arc(c, u, v, radius_px, 0, 2 * kPi);
    stroke_with_edge(c, color, width_px);
  });
}

void draw_crosshair(Image& image, double u, double v, double size_px, Color color,
                    double width_px) {
  draw_into(image, [&](cairo_t* c) {
    for (int i = 0; i < 4; ++i) {
      const double x = i == 0 ? 1 : i == 1 ? -1 : 0, y = i == 2 ? 1 : i == 3 ? -1 : 0;
      cairo_move_to(c, u + 0.35 * size_px * x, v + 0.35 * size_px * y);
      cairo_line_to(c, u + size_px * x, v + size_px * y);
    }
    stroke_with_edge(c, color, width_px);
  });
}

void draw_line(Image& image, std::span<const std::pair<double, double>> corners, Color color,
               double width_px) {
  const std::vector<std::pair<double, double>> line(corners.begin(), corners.end());
  draw_lines(image, std::span(&line, 1), color, width_px);
}

void draw_lines(Image& image, std::span<const std::vector<std::pair<double, double>>> lines,
                Color color, double width_px) {
  draw_into(image, [&](cairo_t* c) {
    cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
    for (const auto& corners : lines) {
      if (corners.empty()) continue;
      for (const auto& [u, v] : corners) cairo_line_to(c, u, v);
      stroke_with_edge(c, color, width_px);
    }
  });
}

void draw_text(Image& image, double u, double v, const std::string& text, double size_px,
               Color color) {
  draw_into(image, [&](cairo_t* c) {
    set_font(c, size_px);
    cairo_move_to(c, u, v);
    cairo_text_path(c, text.c_str());
    set_color(c, kBlack, 0.6);
    cairo_set_line_width(c, 2.4);
    cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke_preserve(c);
    set_color(c, color);
    cairo_fill(c);
  });
}

Image enlarge(const Image& image, int factor) {
  Image large{image.width * factor, image.height * factor, {}};
  large.rgb.reserve(image.rgb.size() * static_cast<std::size_t>(factor * factor));
  for (int y = 0; y < large.height; ++y) {
    for (int x = 0; x < large.width; ++x) {
      const auto at = static_cast<std::size_t>((y / factor * image.width + x / factor) * 3);
      large.rgb.insert(large.rgb.end(), &image.rgb[at], &image.rgb[at] + 3);
    }
  }
  return large;
}

Image resize(const Image& image, int width, int height) {
  if (image.width <= 0 || image.height <= 0 || width <= 0 || height <= 0) return {};
  const Surface to = blank_surface(width, height, kBlack), from = surface_from(image);
  const Context c(cairo_create(to.get()));
  cairo_scale(c.get(), 1.0 * width / image.width, 1.0 * height / image.height);
  cairo_set_source_surface(c.get(), from.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(c.get()), CAIRO_FILTER_GOOD);
  cairo_pattern_set_extend(cairo_get_source(c.get()), CAIRO_EXTEND_PAD);
  cairo_paint(c.get());
  return image_from(to.get());
}

void paste(Image& image, const Image& part, int left, int top) {
  const int begin = std::max(0, -left), end = std::min(part.width, image.width - left);
  if (begin >= end) return;
  for (int y = std::max(0, -top); y < part.height && top + y < image.height; ++y) {
    const auto from = part.rgb.begin() + std::ptrdiff_t{3} * (y * part.width + begin);
    std::copy_n(from, 3 * (end - begin),
                image.rgb.begin() + std::ptrdiff_t{3} * ((top + y) * image.width + left + begin));
  }
}

Image framed(const Image& image) {
  Image all{image.width + 2 * kFrame_px, image.height + 2 * kFrame_px, {}};
  all.rgb.assign(
      std::size_t{3} * static_cast<std::size_t>(all.width) * static_cast<std::size_t>(all.height),
      255);
  paste(all, image, kFrame_px, kFrame_px);
  return all;
}

Image compose(std::span<const Panel> panels, int columns, int height_px) {
  constexpr double kMargin = 16, kCaption = 30, kGap = 14;
  columns = std::max(columns, 1);
  const auto width_of = [&](const Panel& p) {
    return p.image.height > 0 ? std::round(1.0 * height_px * p.image.width / p.image.height) : 0;
  };
  const auto per_row = static_cast<std::size_t>(columns);
  double width = 0;
  for (std::size_t i = 0; i < panels.size(); i += per_row) {
    double row = -kGap;
    for (std::size_t k = i; k < std::min(i + per_row, panels.size()); ++k) {
      row += width_of(panels[k]) + kGap;
    }
    width = std::max(width, row);
  }
  const std::size_t rows = (panels.size() + per_row - 1) / per_row;
  const Surface surface = blank_surface(
      static_cast<int>(width + 2 * kMargin),
      static_cast<int>(static_cast<double>(rows) * (height_px + kCaption) + 2 * kMargin - 6),
      kWhite);
  const Context context(cairo_create(surface.get()));
  cairo_t* c = context.get();
  double x = kMargin, y = kMargin;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    if (i > 0 && i % per_row == 0) {
      x = kMargin;
      y += height_px + kCaption;
    }
    const Panel& panel = panels[i];
    const double w = width_of(panel);
    if (w > 0) {
      const Surface picture = surface_from(panel.image);
      const double scale = 1.0 * height_px / panel.image.height;
      cairo_save(c);
      cairo_rectangle(c, x, y, w, height_px);
      cairo_clip(c);
      cairo_translate(c, x, y);
      cairo_scale(c, scale, scale);
      cairo_set_source_surface(c, picture.get(), 0, 0);
      // Camera pixels are shown as they are; large pictures are made smaller smoothly.
      cairo_pattern_set_filter(cairo_get_source(c),
                               scale >= 2 ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_GOOD);
      cairo_pattern_set_extend(cairo_get_source(c), CAIRO_EXTEND_PAD);
      cairo_paint(c);
      cairo_restore(c);
    }
    set_font(c, 13);
    set_color(c, {0.20, 0.22, 0.25});
    cairo_move_to(c, x + 1, y + height_px + 18);
    cairo_show_text(c, panel.caption.c_str());
    x += w + kGap;
  }
  return image_from(surface.get());
}

}  // namespace kaz::figure
