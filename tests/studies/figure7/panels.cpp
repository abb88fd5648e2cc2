// Both maps of a sweep side by side, true edges drawn in.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/figure7/panels.h"

#include "tools/figure/figure.h"

namespace kaz::figure7 {
namespace {

constexpr int kLarge = 6;                         // px a cell
constexpr double kAhead_m = 1.0, kAside_m = 0.7;  // what is shown

// The part of the map before the robot, which stands in the middle of the lower border.
vision::Image part_of(const map::LocalMap& map, const std::vector<EdgePoint>& edges) {
  const vision::Image all = map.picture();
  const double per_m = 1 / map.options().cell_m;
  const int width = static_cast<int>(2 * kAside_m * per_m);
  const int height = static_cast<int>(kAhead_m * per_m);
  const int left = (all.width - width) / 2, top = all.height / 2 - height;
  vision::Image part{width, height, {}};
  for (int row = 0; row < height; ++row) {
    const auto from = all.rgb.begin() + std::ptrdiff_t{3} * ((top + row) * all.width + left);
    part.rgb.insert(part.rgb.end(), from, from + std::ptrdiff_t{3} * width);
  }
  vision::Image image = figure::enlarge(part, kLarge);
  for (const EdgePoint& edge : edges) {
    if (edge.seen < kSeenOften) continue;
    figure::draw_circle(image, (0.5 * width - edge.place.y() * per_m) * kLarge - 0.5,
                        (height - edge.place.x() * per_m) * kLarge - 0.5, 1, figure::kBlack, 1);
  }
  return image;
}

}  // namespace

vision::Image panels(const Sweep& sweep) {
  const figure::Panel shown[] = {
      {sweep.eye, "left eye, rectified; the head turns at 60 degrees/s"},
      {part_of(sweep.with, sweep.edges), "posture of the exposure: floor green, obstacles red"},
      {part_of(sweep.without, sweep.edges), "posture when the result comes, 0.3 s later"}};
  return figure::compose(shown, 3, 420);
}

}  // namespace kaz::figure7
