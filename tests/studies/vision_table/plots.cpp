// A line plot, and below it a strip of cut-outs of difficult images.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/vision_table/plots.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/studies/vision_table/placement.h"
#include "tests/studies/vision_table/robust_rows.h"
#include "tools/drawing/figure.h"
#include "vision/image/picture_file.h"

namespace kaz::vision_table {
namespace {

using figure::Image;

figure::Image cut_out(const Image& image, int left, int top, int width, int height) {
  Image part{width, height, {}};
  for (int v = top; v < top + height; ++v) {
    const auto row = image.rgb.begin() + (static_cast<std::ptrdiff_t>(v) * image.width + left) * 3;
    part.rgb.insert(part.rgb.end(), row, row + 3 * width);
  }
  return part;
}

Image stacked(const Image& upper, const Image& lower) {
  Image all{std::max(upper.width, lower.width), upper.height + lower.height, {}};
  all.rgb.assign(static_cast<std::size_t>(all.width) * static_cast<std::size_t>(all.height) * 3,
                 255);
  const auto put = [&all](const Image& image, int top) {
    const int left = (all.width - image.width) / 2;
    for (int v = 0; v < image.height; ++v) {
      const auto from = image.rgb.begin() + static_cast<std::ptrdiff_t>(v) * image.width * 3;
      std::copy_n(from, image.width * 3,
                  all.rgb.begin() + (static_cast<std::ptrdiff_t>(v + top) * all.width + left) * 3);
    }
  };
  put(upper, 0);
  put(lower, upper.height);
  return all;
}

figure::PlotPage plot(const Table& table) {
  figure::LinePlot errors;
  errors.title = "Ball of 20 mm radius: distance error, 95th percentile";
  errors.y_label = std::string("%");
  for (const int width : {320, 640}) {
    const figure::Color color = width == 320 ? figure::kOrange : figure::kBlue;
    figure::Series measured{std::to_string(width) + " px wide", color, {}, {}};
    figure::Series limit{"limit", color, {}, {}, 1, figure::Series::Style::dashed};
    for (const AccuracyRow& r : table.accuracy) {
      if (r.width != width || r.visibility != Visibility::whole) continue;
      measured.x.push_back(r.distance_m);
      measured.y.push_back(100 * r.distance.percentile(0.95));
      limit.x.push_back(r.distance_m);
      limit.y.push_back(100 * max_distance_error(width, r.distance_m));
    }
    errors.series.push_back(std::move(measured));
    errors.series.push_back(std::move(limit));
  }
  errors.y_min = 0;
  figure::PlotPage page;
  page.x_label = "distance, m";
  page.plots.push_back(std::move(errors));
  return page;
}

// The first picture of a row with the ball half a metre away, around the ball.
Result<figure::Panel> hard(const std::string& name, const std::string& caption,
                           sim::RendererKind kind) {
  constexpr int kWidth = 80, kHeight = 60, kScale = 2;
  const auto cases = robust_cases();
  const auto row =
      std::find_if(cases.begin(), cases.end(), [&](const auto& c) { return c.name == name; });
  if (row == cases.end()) return fail(Fault::usage, "no row of the name " + name);
  World world(row->floor, row->ball, true, row->clutter);
  const Eyes eyes(320, row->conditions);
  const auto renderer = KAZ_TRY(renderer_of(kind, world));
  Random random(5);
  const Placement place = place_ball(random, eyes.camera(), 0.5, Visibility::whole, world);
  const auto picture = KAZ_TRY(eyes.take_left(*renderer, world.scene.pose, place.eye, 1));
  const auto ball = vision::BallFinder({}).detect(picture, eyes.info(place.eye));
  const int left = std::clamp(static_cast<int>(place.u) - kWidth / 2, 0, picture.width - kWidth);
  const int top = std::clamp(static_cast<int>(place.v) - kHeight / 2, 0, picture.height - kHeight);
  figure::Panel panel{figure::enlarge(cut_out(picture, left, top, kWidth, kHeight), kScale),
                      caption + ": not found"};
  if (!ball.found) return panel;
  const auto at = [](double center, int from) { return (center - from + 0.5) * kScale - 0.5; };
  figure::draw_circle(panel.image, at(ball.center_u, left), at(ball.center_v, top),
                      kScale * ball.radius_px, figure::kYellow, 1.2);
  char text[64];
  std::snprintf(text, sizeof text, ": %.3f m", ball.distance_m);
  panel.caption = caption + text;
  return panel;
}

}  // namespace

Result<void> write_plot(const std::string& path, const Table& table) {
  // Plots are drawn into files only.
  if (auto done = figure::write_plot_png(path, plot(table)); !done) return done;
  const auto upper = KAZ_TRY(vision::read_picture(path));
  const struct {
    const char *name, *caption;
  } rows[] = {{"strong, from the side, 20° high, hard shadows", "strong light"},
              {"dim: an eighth of it", "dim"},
              {"4 times", "noise 4×"},
              {"warm, no white balance", "warm"},
              {"wood, with red and orange objects", "clutter"},
              {"120°/s, 20 ms", "blur 8 px"}};
  std::vector<figure::Panel> panels;
  for (const auto& row : rows) {
    auto panel = KAZ_TRY(hard(row.name, row.caption, table.renderer));
    panels.push_back(std::move(panel));
  }
  return figure::write_png(path, stacked(upper, figure::compose(panels, 6, 120)));
}

}  // namespace kaz::vision_table
