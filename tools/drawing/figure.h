// Draws pictures and plots of results, and writes them to files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/plot/plot.h"
#include "vision/color/color.h"
#include "vision/image/frame.h"

namespace kaz::figure {

using vision::Image;

using plot::Color, plot::kBlue, plot::kRed, plot::kGreen, plot::kOrange, plot::kPurple, plot::kGrey,
    plot::kYellow, plot::kWhite, plot::kBlack;

// --- files
//
// Each function writes to a temporary file in the same folder and then renames the file. Readers therefore
// never see a partial file. Error messages contain the path and the system's reason.

// Returns Fault::usage if the image is empty or inconsistent, or if a side is longer than 32767 px.
Result<void> write_png(const std::string& path, const Image& image);
// `quality`: 1..100.
Result<void> write_jpeg(const std::string& path, const Image& image, int quality = 85);
Result<void> write_file(const std::string& path, std::span<const std::uint8_t> bytes);

// --- pictures
//
// Coordinates are in pixels. Pixel centers are at integers, as in vision/image/frame.h.

// The first function draws a mask in white on black. The second function shows the colors of `picture` where
// the mask is set, and a darkened gray copy of `picture` elsewhere.
Image mask_picture(const vision::Mask& mask);
Image mask_picture(const vision::Mask& mask, const Image& picture);

void draw_circle(Image& image, double u, double v, double radius_px, Color color,
                 double width_px = 2);
// Draws a crosshair with a gap in the middle, so that the marked point stays visible.
void draw_crosshair(Image& image, double u, double v, double size_px, Color color,
                    double width_px = 1.5);
// Draws a line through several points. `corners`: (u, v) of each point.
void draw_line(Image& image, std::span<const std::pair<double, double>> corners, Color color,
               double width_px = 2);
// Draws several lines, each through several points; later lines cover earlier lines.
void draw_lines(Image& image, std::span<const std::vector<std::pair<double, double>>> lines,
                Color color, double width_px = 2);
// Draws text. (u, v) is the left end of the text's baseline.
void draw_text(Image& image, double u, double v, const std::string& text, double size_px,
               Color color);

// Enlarges a picture by copying the nearest pixel, for small camera pictures beside large pictures.
Image enlarge(const Image& image, int factor);

// Scales a picture to any width and height with a smoothing filter. Returns an empty image if a side is not
// positive.
Image resize(const Image& image, int width, int height);

// framed() adds a white frame with a width of kFrame_px. The frame makes a picture visible as an inset of
// another picture.
inline constexpr int kFrame_px = 2;
Image framed(const Image& image);

// Copies `part` into `image`. The upper left corner of `part` goes to column `left` of row `top`. Pixels
// outside `image` are discarded.
void paste(Image& image, const Image& part, int left, int top);

struct Panel {
  Image image;
  std::string caption;
};
// Arranges panels in rows with `columns` panels each. Each panel is scaled to `height_px` and has its caption
// below.
Image compose(std::span<const Panel> panels, int columns, int height_px);

// --- plots

using plot::HorizontalLine, plot::LinePlot, plot::PlotPage, plot::Series, plot::Span;

// Draws at scale 2, so that the plot is sharp on high-resolution screens.
Result<void> write_plot_png(const std::string& path, const PlotPage& page);
Result<void> write_plot_svg(const std::string& path, const PlotPage& page);

}  // namespace kaz::figure
