// Pictures and plots for results: files, overlays, panels with captions, line plots.
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
// ------------------------------------------------------------------------------------------- Every
// write goes to a temporary file beside the target that is then renamed: a reader sees the old file
// or the new one, never half of it. Errors name the path and the system's reason.

Result<void> write_png(const std::string& path, const Image& image);
// quality: 1..100.
Result<void> write_jpeg(const std::string& path, const Image& image, int quality = 85);
Result<void> write_file(const std::string& path, std::span<const std::uint8_t> bytes);

// --- pictures
// ----------------------------------------------------------------------------------------
// Coordinates are pixels with centres at integers, as in vision/image/frame.h.

// White where the mask is set, on black; with `picture`, its own colours on a darkened grey copy.
Image mask_picture(const vision::Mask& mask);
Image mask_picture(const vision::Mask& mask, const Image& picture);

void draw_circle(Image& image, double u, double v, double radius_px, Color color,
                 double width_px = 2);
// Gap in the middle so that what is marked stays visible.
void draw_crosshair(Image& image, double u, double v, double size_px, Color color,
                    double width_px = 1.5);
// Corners as u, v.
void draw_line(Image& image, std::span<const std::pair<double, double>> corners, Color color,
               double width_px = 2);
// Several lines, one after the other, each with its own corners.
void draw_lines(Image& image, std::span<const std::vector<std::pair<double, double>>> lines,
                Color color, double width_px = 2);
void draw_text(Image& image, double u, double v, const std::string& text, double size_px,
               Color color);

// Whole multiples, nearest neighbour: small camera pictures beside large ones.
Image enlarge(const Image& image, int factor);

// Of any size; smooth where it becomes smaller.
Image resize(const Image& image, int width, int height);

// With a white frame around it, so that a picture in a picture is seen as one.
inline constexpr int kFrame_px = 2;
Image framed(const Image& image);

// `part` over `image`, its upper left corner at column `left` of row `top`; what is outside is cut off.
void paste(Image& image, const Image& part, int left, int top);

struct Panel {
  Image image;
  std::string caption;
};
// Side by side in rows of `columns`, each scaled to `height_px`, captions beneath.
Image compose(std::span<const Panel> panels, int columns, int height_px);
// One below the other on white, from the left, without a gap: compose() leaves a margin around its panels.
Image stack(std::span<const Image> images);

// --- plots
// -------------------------------------------------------------------------------------------

using plot::HorizontalLine, plot::LinePlot, plot::PlotPage, plot::Series, plot::Span;

// `scale` pixels for each px of the page.
Image plot_picture(const PlotPage& page, int scale);
// Two pixels for each px: sharp on dense screens.
Result<void> write_plot_png(const std::string& path, const PlotPage& page);
Result<void> write_plot_svg(const std::string& path, const PlotPage& page);

}  // namespace kaz::figure
