// Owning pointers to Cairo surfaces, and conversion between surfaces and images.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cairo.h>

#include <memory>

#include "tools/drawing/figure.h"

namespace kaz::figure {

struct CairoDeleter {
  void operator()(cairo_surface_t* s) const { cairo_surface_destroy(s); }
  void operator()(cairo_t* c) const { cairo_destroy(c); }
};
using Surface = std::unique_ptr<cairo_surface_t, CairoDeleter>;
using Context = std::unique_ptr<cairo_t, CairoDeleter>;

// Makes a 24-bit RGB surface. Check cairo_surface_status(): if the memory allocation failed, the surface is
// in an error state.
Surface blank_surface(int width, int height, Color color);
Surface surface_from(const Image& image);
Image image_from(cairo_surface_t* surface);
Result<void> write_surface_png(const std::string& path, cairo_surface_t* surface);

inline void set_color(cairo_t* c, Color color, double alpha = 1) {
  cairo_set_source_rgba(c, color.r, color.g, color.b, alpha);
}
inline constexpr const char* kFont = "DejaVu Sans";
void set_font(cairo_t* c, double size_px, bool bold = false);

}  // namespace kaz::figure
