// Pictures and plots for results: files, overlays, panels with captions, line plots.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "vision/color/color.h"
#include "vision/image/frame.h"

namespace kaz::figure {

using vision::Image;

struct Color {
  double r = 0, g = 0, b = 0;  // 0..1
};
inline constexpr Color kBlue{0.12, 0.42, 0.75}, kRed{0.84, 0.19, 0.15}, kGreen{0.13, 0.55, 0.30},
    kOrange{0.93, 0.53, 0.11}, kPurple{0.48, 0.32, 0.66}, kGrey{0.45, 0.47, 0.50},
    kYellow{0.98, 0.85, 0.20}, kWhite{1, 1, 1}, kBlack{0, 0, 0};

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
void draw_text(Image& image, double u, double v, const std::string& text, double size_px,
               Color color);

// Whole multiples, nearest neighbour: small camera pictures beside large ones.
Image enlarge(const Image& image, int factor);

struct Panel {
  Image image;
  std::string caption;
};
// Side by side in rows of `columns`, each scaled to `height_px`, captions beneath.
Image compose(std::span<const Panel> panels, int columns, int height_px);

// --- plots
// -------------------------------------------------------------------------------------------

struct Series {
  std::string label;
  Color color;
  std::vector<double> x, y;  // equal lengths; a y that is not finite interrupts the line
  double width_px = 1.8;
  bool dashed = false;
};

struct Span {
  double from = 0, to = 0;  // on the x axis
  Color color = kGreen;
  std::string label;  // in the legend, if not empty
};

struct HorizontalLine {
  double y = 0;
  Color color = kGrey;
  std::string label;
};

struct LinePlot {
  std::string title, y_label;
  std::vector<Series> series;
  std::vector<Span> spans;
  std::vector<HorizontalLine> lines;
  std::optional<double> y_min, y_max;  // otherwise from the data
};

// One above the other on a common x axis.
struct PlotPage {
  std::string title, x_label;
  std::vector<LinePlot> plots;
  int width_px = 960;
  int plot_height_px = 260;
};

Result<void> write_plot_png(const std::string& path, const PlotPage& page);
// Text stays text: it can be searched, and drawn in the reader's font.
Result<void> write_plot_svg(const std::string& path, const PlotPage& page);

}  // namespace kaz::figure
