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
// Each write goes to a temporary file in the same folder, which is then renamed. So readers never see a
// partial file. Errors name the path and the system's reason.

// Returns Fault::usage if the image is empty or inconsistent, or a side is longer than 32767 px.
Result<void> write_png(const std::string& path, const Image& image);
// `quality`: 1..100.
Result<void> write_jpeg(const std::string& path, const Image& image, int quality = 85);
Result<void> write_file(const std::string& path, std::span<const std::uint8_t> bytes);

// --- pictures
//
// Coordinates are pixels with centers at integers, as in vision/image/frame.h.

// Draws a mask in white on black. With `picture`: shows its colors where the mask is set, and a darkened gray
// copy elsewhere.
Image mask_picture(const vision::Mask& mask);
Image mask_picture(const vision::Mask& mask, const Image& picture);

void draw_circle(Image& image, double u, double v, double radius_px, Color color,
                 double width_px = 2);
// Leaves a gap in the middle, so that the marked point stays visible.
void draw_crosshair(Image& image, double u, double v, double size_px, Color color,
                    double width_px = 1.5);
// Draws a polyline. `corners`: (u, v).
void draw_line(Image& image, std::span<const std::pair<double, double>> corners, Color color,
               double width_px = 2);
// Draws several polylines, later ones on top.
void draw_lines(Image& image, std::span<const std::vector<std::pair<double, double>>> lines,
                Color color, double width_px = 2);
// (u, v): left end of the text's baseline.
void draw_text(Image& image, double u, double v, const std::string& text, double size_px,
               Color color);

// Enlarges a picture by nearest neighbor, for small camera pictures beside large ones.
Image enlarge(const Image& image, int factor);

// Scales a picture to any size, with a smoothing filter. Returns an empty image if a side is not positive.
Image resize(const Image& image, int width, int height);

// Adds a white frame, so that a picture in a picture stands out.
inline constexpr int kFrame_px = 2;
Image framed(const Image& image);

// Copies `part` into `image`, with its upper left corner at column `left` of row `top`. Clips the rest.
void paste(Image& image, const Image& part, int left, int top);

struct Panel {
  Image image;
  std::string caption;
};
// Arranges panels in rows of `columns`, each scaled to `height_px`, with captions below.
Image compose(std::span<const Panel> panels, int columns, int height_px);
// Stacks images vertically on white, left-aligned, without gaps: results of compose() have a margin already.
Image stack(std::span<const Image> images);

// --- plots

using plot::HorizontalLine, plot::LinePlot, plot::PlotPage, plot::Series, plot::Span;

// `scale`: pixels for each px of the page.
Image plot_picture(const PlotPage& page, int scale);
// Draws at scale 2, which is sharp on dense screens.
Result<void> write_plot_png(const std::string& path, const PlotPage& page);
Result<void> write_plot_svg(const std::string& path, const PlotPage& page);

}  // namespace kaz::figure
