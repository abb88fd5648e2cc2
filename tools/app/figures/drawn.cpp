// Lays the figures out, and sums up what they show.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/figures/drawn.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "shared/base/angle.hpp"
#include "tools/app/figures/frame_information/panels.h"
#include "tools/app/session/map_picture.h"
#include "tools/app/vision/report.h"
#include "tools/figure/vision_views.h"
#include "vision/color/color.h"

namespace kaz::tools {
namespace {

using Eigen::Vector2d;
using Json = nlohmann::ordered_json;

template <class... Values>
std::string text(const char* format, Values... values) {
  char line[160];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

double rounded(double value, double unit) {
  return std::round(value / unit) / std::round(1 / unit) + 0.0;  // no negative zero
}

struct CellCounts {
  int floor = 0, obstacle = 0;
};

CellCounts counts_of(const map::LocalMap& map) {
  CellCounts counts;
  for (int x = 0; x < map.cells(); ++x) {
    for (int y = 0; y < map.cells(); ++y) {
      const map::CellState state = map.cell(x, y).state;
      counts.floor += state == map::CellState::floor ? 1 : 0;
      counts.obstacle += state == map::CellState::obstacle ? 1 : 0;
    }
  }
  return counts;
}

Json counts_json(const map::LocalMap& map) {
  const CellCounts counts = counts_of(map);
  const double area = map.options().cell_m * map.options().cell_m;
  return {{"floor_m2", rounded(counts.floor * area, 1e-4)},
          {"obstacle_m2", rounded(counts.obstacle * area, 1e-4)}};
}

Json point_json(const Vector2d& at) {
  return {rounded(at.x(), 1e-4), rounded(at.y(), 1e-4)};
}

}  // namespace

Result<DrawnFigure> draw_scene(const RunCollector& run) {
  constexpr int kHeight_px = 330, kArrowEvery_px = 12;
  constexpr double kStretch = 2;
  if (!run.scene())
    return fail(Fault::failed,
                "figure 3: no picture of the run has the ball, depth and optical flow at once");
  const SceneView& scene = *run.scene();
  const vision::Image& left = scene.images->left;
  // Beside each other in the upper right corner: the ball is before the robot, towards the onlooker.
  figure::Image outside = scene.outside;
  constexpr int kMargin_px = 12;
  int column = outside.width;
  for (const vision::Image* eye : {&scene.images->right, &left}) {
    const figure::Image shown = figure::framed(*eye);
    column -= shown.width + kMargin_px;
    figure::paste(outside, shown, column, kMargin_px);
  }
  vision::Mask mask;
  vision::ColorExtractor(vision::BallOptions().color).extract(left, mask);
  const double age_s = scene.flow.seconds_between();
  const figure::Panel panels[] = {
      {outside, text("(A) robot and view simulator, %.2f s; both eyes' pictures",
                     seconds(scene.ball.info.exposure))},
      {figure::enlarge(figure::mask_picture(mask, left), 2),
       text("(B) color extraction: the ball, %.2f m away by its size", scene.ball.distance_m)},
      {figure::enlarge(figure::depth_picture(scene.depth), 2),
       "(C) depth: red 0.2 m, green 0.7 m, blue 3 m, black none"},
      {figure::flow_arrows(left, scene.flow, 2, kArrowEvery_px, kStretch),
       text("(D) optical flow of %.0f ms, arrows twice as long", 1e3 * age_s)}};
  const auto pixels = std::ranges::count_if(mask.pixels, [](std::uint8_t m) { return m != 0; });
  return DrawnFigure{figure::compose(panels, 2, kHeight_px),
                     {{"exposure_s", seconds(scene.ball.info.exposure)},
                      {"ball", ball_json(scene.ball)},
                      {"ball_moved_px", rounded(scene.ball_moved_px, 1e-3)},
                      {"color", {{"pixels", pixels}}},
                      {"depth", depth_json(scene.depth)},
                      {"flow", flow_json(scene.flow)}}};
}

Result<DrawnFigure> draw_setup(const RunCollector& run) {
  constexpr int kHeight_px = 400;
  if (!run.setup() || run.setup()->from_side.rgb.empty() || run.setup()->from_above.rgb.empty())
    return fail(Fault::failed, "figure 5: the world was not drawn");
  SetupView setup = *run.setup();
  constexpr double kText_px = 30, kAside_px = 24;
  const auto label = [&](const std::pair<double, double>& at, const char* name) {
    figure::draw_text(setup.from_above, at.first + kAside_px, at.second + kText_px / 3, name,
                      kText_px, figure::kWhite);
  };
  label({setup.robot_px.first + kAside_px, setup.robot_px.second}, "robot");
  if (setup.ball_px) label(*setup.ball_px, "ball");
  const figure::Panel panels[] = {
      {setup.from_side, setup.ball_m
                            ? text("the ball is %.2f m from the robot", setup.ball_m->norm())
                            : std::string("before the robot walks")},
      {setup.from_above, "the same scene from above"}};
  Json numbers = Json::object();
  if (setup.ball_m) numbers["ball_m"] = point_json(*setup.ball_m);
  return DrawnFigure{figure::compose(panels, 2, kHeight_px), std::move(numbers)};
}

// (A) planes, and (B) below each the floor that it shows; (C) the merged map, (D) the path.
Result<DrawnFigure> draw_map_and_path(const RunCollector& run) {
  constexpr int kSmall_px = 183, kMaxLarge_px = 520;
  constexpr double kRow_px = 5 * 244 + 4 * 14;  // five pictures of 4 : 3 and the gaps between them
  constexpr double kAhead = 1.2, kAside = 0.8, kGrid = 0.1;  // m
  if (run.look_around().empty())
    return fail(Fault::failed, "figure 6: the robot took no picture while it looked around");
  if (!run.plan()) return fail(Fault::failed, "figure 6: the run has no planned path");
  const PlanView& plan = *run.plan();
  std::vector<figure::Panel> views, floors;
  Json frames = Json::array();
  for (const PlaneView& view : run.look_around()) {
    auto map = KAZ_TRY(map::LocalMap::make(plan.map.options()));
    KAZ_TRY(map.update(view.planes, view.depth, view.planes.info));
    const MapWindow window{{0, -kAside}, {kAhead, kAside}, 2 / map.options().cell_m};
    const double pan_deg = rounded(view.pan_rad / kDegree, 0.01);
    views.push_back({figure::plane_picture(view.images->left, view.planes, figure::kRed),
                     text("(A) %.2f s, head %+d\u00b0", seconds(view.planes.info.exposure),
                          static_cast<int>(std::lround(pan_deg)))});
    floors.push_back({map_cells(map, window, MapColors::states),
                      text("(B) floor: %.2f m\u00b2", counts_json(map)["floor_m2"].get<double>())});
    Json frame{{"exposure_s", seconds(view.planes.info.exposure)},
               {"pan_deg", pan_deg},
               {"planes", view.planes.segments.size()},
               {"floor_found", view.planes.floor_found()}};
    frame.update(counts_json(map));
    frames.push_back(std::move(frame));
  }
  const std::vector<Vector2d> trail;
  const MapWindow window =
      window_of({plan.time, plan.map, plan.robot, plan.heading_rad, plan.path, trail, plan.goal});
  const figure::Image merged = map_cells(plan.map, window, MapColors::paper);
  figure::Image path = map_cells(plan.map, window, MapColors::states);
  draw_map_grid(path, window, kGrid, figure::kGrey);
  draw_map_line(path, window, plan.path, figure::kRed, 4);
  for (const Vector2d& corner : plan.path) {
    const auto [u, v] = window.pixel(corner);
    figure::draw_circle(path, u, v, 4, figure::kRed, 3);
  }
  draw_map_robot(path, window, plan.robot, plan.heading_rad);
  const auto [goal_u, goal_v] = window.pixel(plan.goal);
  figure::draw_crosshair(path, goal_u, goal_v, 18, figure::kBlue, 4);
  double length = 0;
  for (std::size_t i = 1; i < plan.path.size(); ++i)
    length += (plan.path[i] - plan.path[i - 1]).norm();
  const figure::Panel maps[] = {
      {merged, "(C) merged map: floor white, brighter if certain, obstacles black, unseen gray"},
      {path, text("(D) path (red), %.2f m, toward the goal (blue); grid of %.0f cm", length,
                  100 * kGrid)}};
  Json corners = Json::array();
  for (const Vector2d& corner : plan.path) corners.push_back(point_json(corner));
  const auto row = static_cast<int>(views.size());
  // Both maps together as wide as the rows above.
  const int large_px =
      std::min(kMaxLarge_px, static_cast<int>((kRow_px - 14) / 2 * merged.height / merged.width));
  const figure::Image rows[] = {figure::compose(views, row, kSmall_px),
                                figure::compose(floors, row, kSmall_px),
                                figure::compose(maps, 2, large_px)};
  return DrawnFigure{figure::stack(rows),
                     {{"frames", std::move(frames)},
                      {"map", counts_json(plan.map)},
                      {"planned_s", seconds(plan.time)},
                      {"path_m", std::move(corners)},
                      {"path_length_m", rounded(length, 1e-4)},
                      {"goal_m", point_json(plan.goal)}}};
}

DrawnFigure draw_frame_information(const figure7::Sweep& sweep, const figure7::Options& options) {
  const auto score = [&](const map::LocalMap& map) {
    const figure7::EdgeScore s = figure7::score(figure7::edge_errors(map, sweep.edges, 0.2, 0.8));
    Json json{{"places", s.points},
              {"mean_mm", rounded(1e3 * s.mean_m, 0.01)},
              {"median_mm", rounded(1e3 * s.median_m, 0.01)},
              {"p95_mm", rounded(1e3 * s.p95_m, 0.01)},
              {"max_mm", rounded(1e3 * s.max_m, 0.01)}};
    json.update(counts_json(map));
    return json;
  };
  const auto [least, most] =
      std::ranges::minmax_element(sweep.swept, {}, &figure7::SweptPicture::floor_share);
  const figure::Image rows[] = {figure7::panels(sweep),
                                figure::plot_picture(figure7::plots(sweep), 1)};
  return {
      figure::stack(rows),
      {{"pictures", sweep.pictures},
       {"without_floor", sweep.without_floor},
       {"floor_share",
        {{"min", rounded(least->floor_share, 1e-4)}, {"max", rounded(most->floor_share, 1e-4)}}},
       {"delay_s", seconds(options.delay)},
       {"fastest_deg_per_s", rounded(sweep.fastest_rad_per_s / kDegree, 0.1)},
       {"edge_errors",
        {{"with_frame_information", score(sweep.with)}, {"without", score(sweep.without)}}}}};
}

// Above what an onlooker sees, below the left eye.
Result<DrawnFigure> draw_catch(const RunCollector& run) {
  constexpr int kHeight_px = 190;
  const std::vector<MomentPictures>& moments = run.moments();
  if (moments.empty())
    return fail(
        Fault::failed,
        "figure 8: no picture was taken while the robot searched, tracked or caught the ball");
  std::vector<figure::Panel> above, below;
  Json shown = Json::array();
  for (const MomentPictures& moment : moments) {
    above.push_back(
        {moment.outside, text("%s, %.1f s", moment.shown.c_str(), seconds(moment.time))});
    below.push_back({moment.left, moment.found
                                      ? text("left eye: ball %.2f m away", moment.distance_m)
                                      : std::string("left eye: ball not found")});
    Json one{{"shown", moment.shown}, {"time_s", seconds(moment.time)}, {"found", moment.found}};
    if (moment.found) one["distance_m"] = rounded(moment.distance_m, 1e-4);
    shown.push_back(std::move(one));
  }
  const auto columns = static_cast<int>(moments.size());
  above.insert(above.end(), below.begin(), below.end());
  return DrawnFigure{figure::compose(above, columns, kHeight_px), {{"moments", std::move(shown)}}};
}

}  // namespace kaz::tools
