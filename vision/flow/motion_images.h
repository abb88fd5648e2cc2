// Two pictures asked which of two flows fits them better, and for the flow of a whole region.
// Inside of vision/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace kaz::vision {

// 8 bits, one channel or RGB, read as grey codes: (r + 2 g + b) / 4.
struct GreyReader {
  int width, height, channels;
  std::span<const std::uint8_t> bytes;

  float at(int u, int v) const {
    const std::size_t i = (static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(u)) *
                          static_cast<std::size_t>(channels);
    if (channels == 1) return bytes[i];
    return static_cast<float>(bytes[i] + 2 * bytes[i + 1] + bytes[i + 2]) * 0.25F;
  }
  bool holds(double u, double v) const {
    return u >= 0 && v >= 0 && u < width - 1 && v < height - 1;
  }
  double between(double u, double v) const;  // bilinear; where holds()
};

// Mean square of the change, codes^2, of the pixels within `reach` of (u, v) along this flow;
// NaN where that leaves a picture.
double misfit(const GreyReader& before, const GreyReader& after, int u, int v, int reach,
              const Eigen::Vector2d& flow_px);

// One flow for all of these pixels (squares of `side` px with these corners), from a first guess:
// least squares on the change of brightness (B. Lucas, T. Kanade 1981), pixels that do not fit
// weighing less (Geman and McClure's weights at 12 codes). False if there is no texture to hold on
// to, or it leads further than 3 px from the guess, or out of the picture.
bool refine_flow(const GreyReader& before, const GreyReader& after,
                 std::span<const Eigen::Vector2i> corners, int side, Eigen::Vector2d& flow_px);

// Middle of the pixels from (left, top) to (right, bottom) that went along `flow_px` and did not
// rest, `rest_px`. A ball of one colour shows that at its two ends alone: at the one that it
// leaves, before, and at the one that it comes to, after; both count. False if there are none.
bool moved_middle(const GreyReader& before, const GreyReader& after, int left, int top, int right,
                  int bottom, const Eigen::Vector2d& flow_px, const Eigen::Vector2d& rest_px,
                  Eigen::Vector2d& middle);

}  // namespace kaz::vision
