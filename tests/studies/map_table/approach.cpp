// Walks, pictures, and the map against the truth.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/map_table/approach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/map/local_map.h"
#include "shared/base/random.hpp"
#include "tests/studies/vision_table/eyes.h"
#include "tools/eval/map_truth.h"
#include "vision/depth/depth.h"
#include "vision/planes/floor_edges.h"
#include "vision/planes/plane_segments.h"

namespace kaz::map_table {
namespace {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;

constexpr int kWidth = 320;
constexpr double kEyeAhead = 0.03, kEyeHeight = 0.33,
                 kTilt = 35 * std::numbers::pi / 180;  // navigate's
constexpr double kStep = 0.01, kStep_s = 0.2;          // m, s, between two pictures: 5 cm/s
// One sigma of where the eyes are taken to be: no less than measured of walking robots
// (docs/results/README.md).
constexpr double kTurnError = 0.65 * std::numbers::pi / 180, kHeightError = 0.004,
                 kPlaceError = 0.003;
constexpr double kHands = 0.16,
                 kStride = 0.033;  // m: what the robot's middle keeps clear of; a step
// Cells of an obstacle, so near to the thing, that stop a robot (host/behavior/walking_map.cpp).
constexpr int kStops = 2;
constexpr double kAtThing = 0.025;
constexpr double kOwnBody = 0.22;       // m, as navigate has it
constexpr double kCompareEvery = 0.25;  // m

constexpr std::array<std::array<double, 3>, 5> kColors{{{0.16, 0.33, 0.70},
                                                        {0.90, 0.76, 0.16},
                                                        {0.42, 0.30, 0.62},
                                                        {0.88, 0.87, 0.84},
                                                        {0.30, 0.28, 0.27}}};

struct Draw {
  Random random;
  double operator()(double low, double high) { return low + (high - low) * random.uniform(); }
};

tools::Obstacle draw_thing(Thing thing, Draw& draw) {
  tools::Obstacle o;
  o.x_m = draw(0.9, 1.1);
  o.y_m = draw(-0.08, 0.08);
  o.yaw_rad = draw(-std::numbers::pi, std::numbers::pi);
  o.length_m = draw(0.08, 0.20);
  o.width_m = draw(0.08, 0.20);
  o.height_m = draw(0.08, 0.24);
  o.rgb = kColors[draw.random.below(kColors.size())];
  if (thing == Thing::low_box) o.height_m = 0.02;
  if (thing == Thing::pole || thing == Thing::can) {
    o.shape = tools::Shape::can;
    o.length_m = o.width_m = thing == Thing::pole ? 0.005 : draw(0.06, 0.10);
  }
  if (thing == Thing::pole) o.height_m = draw(0.20, 0.45);
  return o;
}

void add_thing(const tools::Obstacle& o, sim::TestScene& scene) {
  const sim::Rgb color{static_cast<float>(o.rgb[0]), static_cast<float>(o.rgb[1]),
                       static_cast<float>(o.rgb[2])};
  const Vector3d at(o.x_m, o.y_m, o.height_m / 2);
  const bool box = o.shape == tools::Shape::box;
  const int frame =
      box ? scene.add(sim::Shape::Kind::box, {o.length_m, o.width_m, o.height_m}, at, color)
          : scene.add(sim::Shape::Kind::cylinder, {o.length_m / 2, o.height_m, 0}, at, color);
  scene.pose.frames[static_cast<std::size_t>(frame)].linear() =
      Eigen::AngleAxisd(o.yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
}

// The lamp anywhere, 35 to 80 degrees high; for the dark side beyond the thing, 25 to 45 degrees high.
vision_table::Conditions draw_light(Thing thing, Draw& draw) {
  const bool beyond = thing == Thing::dark_side;
  const double azimuth = beyond ? draw(-0.4, 0.4) : draw(-std::numbers::pi, std::numbers::pi);
  const double height = (beyond ? draw(25, 45) : draw(35, 80)) * std::numbers::pi / 180;
  vision_table::Conditions conditions;
  conditions.light.to_key = {std::cos(height) * std::cos(azimuth),
                             std::cos(height) * std::sin(azimuth), std::sin(height)};
  conditions.light.key = beyond ? 1.3 : draw(0.5, 1.3);
  conditions.light.shaded = beyond ? 0.6 : draw(0.6, 1.3);
  return conditions;
}

// Turned about all axes and moved, as posture and odometry err.
Isometry3d mistaken(const Isometry3d& eye, std::uint64_t seed, std::uint64_t number) {
  const auto normal = [&](std::uint64_t channel) { return keyed_normal(seed, number, channel); };
  Isometry3d thought = eye;
  thought.linear() = Eigen::AngleAxisd(kTurnError * normal(0), Vector3d::UnitX()) *
                     Eigen::AngleAxisd(kTurnError * normal(1), Vector3d::UnitY()) *
                     Eigen::AngleAxisd(kTurnError * normal(2), Vector3d::UnitZ()) * eye.linear();
  thought.translation() +=
      Vector3d(kPlaceError * normal(3), kPlaceError * normal(4), kHeightError * normal(5));
  return thought;
}

class Walk {
 public:
  Walk(const tools::Obstacle& thing, const vision_table::Conditions& light, std::uint64_t seed,
       map::LocalMap map)
      : thing_(thing), eyes_(kWidth, light), seed_(seed), map_(std::move(map)), truth_({thing}) {}

  Result<void> look(double walked, sim::Renderer& renderer, const sim::ScenePose& pose) {
    ++number_;
    const Vector3d at(walked + kEyeAhead, 0, kEyeHeight);
    const Isometry3d eye = sim::look_at(at, at + Vector3d(std::cos(kTilt), 0, -std::sin(kTilt)));
    now_ += from_seconds(kStep_s);
    const auto images = KAZ_TRY(eyes_.take(renderer, pose, eye, number_));
    truth_.look(now_, eye, eyes_.camera());
    vision::FrameInfo info = eyes_.info(mistaken(eye, seed_, number_));
    // Of the foot that stands below the robot.
    info.foot_from_eye.translation().x() -= walked;
    info.sequence = number_;
    info.exposure = now_;
    // Pictures of one colour are an error, as they should be: nothing is entered.
    if (!depths_.find(images, info, depth_)) return {};
    if (!planes_of_.find(depth_, planes_)) return {};
    KAZ_TRY(edges_.sharpen(images.left, planes_));
    return map_.update(planes_, depth_, info, Isometry3d(Eigen::Translation3d(walked, 0, 0)));
  }
  void compare(double walked) {
    const std::vector<Vector2d> none;
    const Eigen::Isometry2d robot(Eigen::Translation2d(walked, 0));
    truth_.compare({now_, map_, {walked, 0}, 0, none, none, {2, 0}}, robot);
  }
  bool stops() const {
    int cells = 0;
    const double reach = kAtThing + std::max(thing_.length_m, thing_.width_m);
    for (int x = map_.number(thing_.x_m - reach); x <= map_.number(thing_.x_m + reach); ++x) {
      for (int y = map_.number(thing_.y_m - reach); y <= map_.number(thing_.y_m + reach); ++y) {
        const Vector2d at(map_.middle(x), map_.middle(y));
        cells += map_.certain(x, y) == map::CellState::obstacle &&
                 tools::distance_to(thing_, at) <= kAtThing;
      }
    }
    return cells >= kStops;
  }
  Found found() const {
    const auto json = truth_.json();
    const auto count = [&](const char* name) { return json[name].template get<int>(); };
    return {1,
            stops() ? 1 : 0,
            count("outline_points"),
            count("outline_found"),
            count("floor_cells"),
            count("floor_wrong")};
  }

 private:
  tools::Obstacle thing_;
  vision_table::Eyes eyes_;
  std::uint64_t seed_, number_ = 0;
  map::LocalMap map_;
  tools::MapTruth truth_;
  Time now_{};
  vision::DepthFinder depths_;
  vision::PlaneSegmentFinder planes_of_;
  vision::FloorEdges edges_;
  vision::DepthImage depth_;
  vision::PlaneSegments planes_;
};

}  // namespace

void Found::add(const Found& other) {
  things += other.things;
  in_time += other.in_time;
  outline_points += other.outline_points;
  outline_found += other.outline_found;
  floor_cells += other.floor_cells;
  floor_wrong += other.floor_wrong;
}

Result<Found> approach(const std::string& floor, Thing thing, std::uint64_t seed,
                       sim::RendererKind renderer_kind) {
  Draw draw{Random(seed)};
  const tools::Obstacle obstacle = draw_thing(thing, draw);
  const vision_table::Conditions light = draw_light(thing, draw);
  vision_table::World world(floor, sim::kRedBall, false, false);
  add_thing(obstacle, world.scene);
  auto renderer = KAZ_TRY(vision_table::renderer_of(renderer_kind, world));
  map::LocalMapOptions options;
  options.own_m = kOwnBody;
  Walk walk(obstacle, light, seed, KAZ_TRY(map::LocalMap::make(options)));
  double compared = 0;
  for (double walked = 0; tools::distance_to(obstacle, {walked, 0}) > kHands + kStride;
       walked += kStep) {
    KAZ_TRY(walk.look(walked, *renderer, world.scene.pose));
    if (walked - compared < kCompareEvery) continue;
    compared = walked;
    walk.compare(walked);
  }
  return walk.found();
}

}  // namespace kaz::map_table
