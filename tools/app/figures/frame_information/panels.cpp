// Both maps of a sweep side by side, true edges drawn in.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/figures/frame_information/panels.h"

#include "shared/base/angle.hpp"
#include "tools/app/session/map_picture.h"
#include "tools/figure/figure.h"

namespace kaz::figure7 {
namespace {

// The part of the map before the robot, which stands in the middle of the lower border; true edges black.
vision::Image part_of(const map::LocalMap& map, const std::vector<EdgePoint>& edges) {
  constexpr double kCell_px = 6;
  const tools::MapWindow window{{0, -0.7}, {1, 0.7}, kCell_px / map.options().cell_m};
  vision::Image image = tools::map_cells(map, window, tools::MapColors::green_red);
  for (const EdgePoint& edge : edges) {
    if (edge.seen < kSeenOften) continue;
    const auto [u, v] = window.pixel(edge.place);
    figure::draw_circle(image, u, v, 1, figure::kBlack, 3);
  }
  return image;
}

}  // namespace

vision::Image panels(const Sweep& sweep) {
  const figure::Panel shown[] = {
      {sweep.eye, "left eye, rectified; the head turns at 60\u00b0/s"},
      {part_of(sweep.with, sweep.edges), "posture at the exposure: floor green, obstacles red"},
      {part_of(sweep.without, sweep.edges), "posture when the result arrives, 0.3 s later"}};
  return figure::compose(shown, 3, 250);
}

plot::PlotPage plots(const Sweep& sweep) {
  constexpr int kWidth_px = 1093, kHeight_px = 190;  // as wide as the panels
  using plot::Series;
  const auto line = [](const char* label, plot::Color color) {
    return Series{label, color, {}, {}};
  };
  Series then = line("at the exposure (frame information)", figure::kBlue);
  Series now = line("when the result arrives", figure::kRed);
  Series share = line("", figure::kGreen);
  Series with = line("posture at the exposure", figure::kBlue);
  Series without = line("posture when the result arrives", figure::kRed);
  const double cell_m2 = sweep.with.options().cell_m * sweep.with.options().cell_m;
  for (const SweptPicture& picture : sweep.swept) {
    const double t = seconds(picture.exposure);
    for (Series* series : {&then, &now, &share, &with, &without}) series->x.push_back(t);
    then.y.push_back(picture.pan_then_rad / kDegree);
    now.y.push_back(picture.pan_now_rad / kDegree);
    share.y.push_back(100 * picture.floor_share);
    with.y.push_back(cell_m2 * picture.floor_with);
    without.y.push_back(cell_m2 * picture.floor_without);
  }
  plot::PlotPage page;
  page.x_label = "exposure of the picture, s";
  page.width_px = kWidth_px;
  page.plot_height_px = kHeight_px;
  page.plots = {{"Pan of the head", "degrees", {then, now}, {}, {}, -60, 60, {}},
                {"Floor found in the left picture", "% of its pixels", {share}, {}, {}, 0, {}, {}},
                {"Floor in the map", "m\u00b2", {with, without}, {}, {}, 0, {}, {}}};
  return page;
}

}  // namespace kaz::figure7
