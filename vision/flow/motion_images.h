// Computes flow, photometric error and center of a moving region from two images. Internal to vision/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace kaz::vision {

// Converts 8-bit pixels to gray codes. If `channels` is 1, the pixels are copied. If `channels` is 3, a code
// is exactly (r + 2 g + b) / 4.
void grey_codes(std::span<const std::uint8_t> bytes, int channels, std::vector<float>& codes);

struct GreyReader {
  int width, height;
  std::span<const float> codes;  // rows without padding

  float at(int u, int v) const {
    return codes[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(u)];
  }
  bool holds(double u, double v) const {
    return u >= 0 && v >= 0 && u < width - 1 && v < height - 1;
  }
  // Interpolates bilinearly. holds(u, v) must be true.
  double between(double u, double v) const {
    const int i = static_cast<int>(u), j = static_cast<int>(v);
    const double s = u - i, t = v - j;
    const float *const here = &codes[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                                     static_cast<std::size_t>(i)],
                       *const below = here + width;
    return (1 - t) * ((1 - s) * static_cast<double>(here[0]) + s * static_cast<double>(here[1])) +
           t * ((1 - s) * static_cast<double>(below[0]) + s * static_cast<double>(below[1]));
  }
};

// Compares a square of the earlier image with the square of the later image that is displaced by `flow_px`.
// The square contains the pixels within `reach` px of (u, v). Returns the mean squared difference of the gray
// codes (codes^2), or NaN if the displaced square is not inside the later image.
double misfit(const GreyReader& before, const GreyReader& after, int u, int v, int reach,
              const Eigen::Vector2d& flow_px);

// Refines `flow_px`, the common translation of all pixels of several squares. Each square has a side of
// `side` px; `corners` has the upper left corner of each square. Method: Gauss-Newton on the brightness
// difference (B. Lucas, T. Kanade 1981), with Geman-McClure weights of scale 12 codes. Returns false if the
// texture is insufficient, or the refined flow leaves the image. Also returns false if the refined flow
// differs from the initial flow by more than 3 px.
bool refine_flow(const GreyReader& before, const GreyReader& after,
                 std::span<const Eigen::Vector2i> corners, int side, Eigen::Vector2d& flow_px);

// Finds the center of the pixels in the box (left, top)..(right, bottom) that move by `flow_px`. Pixels that
// move by `rest_px` are excluded, because `rest_px` is the flow of a static point. In an object of uniform
// color, only the pixels at the leading and trailing edges show the motion. The pixels of both edges count.
// Returns false if no pixel moves by `flow_px`.
bool moved_middle(const GreyReader& before, const GreyReader& after, int left, int top, int right,
                  int bottom, const Eigen::Vector2d& flow_px, const Eigen::Vector2d& rest_px,
                  Eigen::Vector2d& middle);

}  // namespace kaz::vision
