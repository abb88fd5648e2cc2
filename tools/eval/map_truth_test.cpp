// Maps that are right, shifted, empty or invent something, against a box.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/map_truth.h"

#include <gtest/gtest.h>

#include "host/map/local_map.h"
#include "host/map/view_testing.h"

namespace kaz::tools {
namespace {

using Eigen::Isometry2d, Eigen::Vector2d;

// A box 0.45 to 0.55 m ahead, 5 cm to the right to 15 cm to the left: as the yard, and as the truth.
const map::TestYard kYard{{{{0.50, 0.05, 0.05}, {0.10, 0.20, 0.10}}}};
Obstacle box() {
  Obstacle o;
  o.x_m = 0.50;
  o.y_m = 0.05;
  o.length_m = 0.10;
  o.width_m = 0.20;
  return o;
}

map::LocalMap map_of(const map::TestYard& yard) {
  auto map = map::LocalMap::make({}).value();
  for (std::uint64_t k = 1; k <= 3; ++k) {
    const auto view = yard.seen(map::test_eye(0, 0.5), 0.1, k);
    EXPECT_TRUE(map.update(view.planes, view.depth, view.depth.info));
  }
  return map;
}

struct Shares {
  double found, wrong;
};
// The robot stands at `robot` and thinks that it is at `thought`.
Shares compared(const map::LocalMap& map, const Isometry2d& robot = Isometry2d::Identity(),
                const Vector2d& thought = {0, 0}, int looks = 10) {
  MapTruth truth({box()});
  Eigen::Isometry3d start_from_eye = map::test_eye(0, 0.5);
  start_from_eye.translation().head<2>() += robot.translation();
  for (int i = 0; i < looks; ++i)
    truth.look(from_seconds(0.1 * i), start_from_eye, vision::test_camera(320, 240));
  const std::vector<Vector2d> none;
  truth.compare({Time{}, map, thought, 0, none, none, {1, 0}}, robot);
  const auto json = truth.json();
  const double points = json["outline_points"].get<double>(),
               cells = json["floor_cells"].get<double>();
  return {points > 0 ? json["outline_found"].get<double>() / points : -1,
          cells > 0 ? json["floor_wrong"].get<double>() / cells : -1};
}

TEST(MapTruth, AMapOfTheWorldIsRight) {
  const Shares shares = compared(map_of(kYard));
  EXPECT_GT(shares.found, 0.97);
  EXPECT_LT(shares.wrong, 0.005);
  EXPECT_GE(shares.wrong, 0);
}

TEST(MapTruth, ABoxThatIsNotInTheMapIsMissed) {
  EXPECT_EQ(compared(map_of({})).found, 0);
}

TEST(MapTruth, AnInventedBoxIsFloorTakenForAnObstacle) {
  map::TestYard yard = kYard;
  yard.boxes.push_back({{0.6, -0.3, 0.05}, {0.1, 0.1, 0.1}});
  EXPECT_GT(compared(map_of(yard)).wrong, 0.005);
}

// The map's frame has drifted by 20 cm, and the robot stands where it thinks in it.
TEST(MapTruth, DriftDoesNotCountButAPlaceThatIsWrongDoes) {
  Isometry2d robot = Isometry2d::Identity();
  EXPECT_LT(compared(map_of(kYard), robot, {0.2, 0}).found, 0.5);
  MapTruth truth({box()});
  map::TestYard drifted = kYard;
  drifted.boxes[0].middle.x() += 0.2;
  const auto map = map_of(drifted);
  for (int i = 0; i < 10; ++i)
    truth.look(from_seconds(0.1 * i), map::test_eye(0, 0.5), vision::test_camera(320, 240));
  const std::vector<Vector2d> none;
  truth.compare({Time{}, map, {0.2, 0}, 0, none, none, {1, 0}}, robot);
  EXPECT_GT(
      truth.json()["outline_found"].get<double>() / truth.json()["outline_points"].get<double>(),
      0.9);
}

// Outline points of the box in view if a rod of the robot's own, 2 cm wide, stands upright 20 cm ahead of the
// eyes' foot and at `aside_m`.
int points_behind_a_rod(double aside_m) {
  sim::Scene scene;
  scene.frames = {"world", "arm"};
  sim::Visual rod;
  rod.frame = 1;
  rod.shape = {sim::Shape::Kind::box, {0.02, 0.02, 0.6}, nullptr, ""};
  scene.visuals.push_back(rod);
  sim::ScenePose pose;
  pose.frames.assign(2, Eigen::Isometry3d::Identity());
  pose.frames[1].translation() = Eigen::Vector3d(0.20, aside_m, 0.3);
  const std::vector<std::string> links{"arm"};
  OwnBody own = OwnBody::make(scene, links).value();
  own.move(pose, Eigen::Isometry3d::Identity());
  MapTruth truth({box()});
  for (int i = 0; i < 10; ++i)
    truth.look(from_seconds(0.1 * i), map::test_eye(0, 0.5), vision::test_camera(320, 240), &own);
  const std::vector<Vector2d> none;
  truth.compare({Time{}, map_of({}), {0, 0}, 0, none, none, {1, 0}}, Isometry2d::Identity());
  return truth.json()["outline_points"].get<int>();
}

TEST(MapTruth, WhatTheRobotsOwnLimbsHideFromAnEyeIsNotInView) {
  const int all = points_behind_a_rod(-0.5), behind = points_behind_a_rod(0.02);
  // Side by side on the box: a strip of 5 cm for each eye.
  EXPECT_LE(behind, all - 8);
  EXPECT_GE(behind, all - 12);
}

TEST(MapTruth, WhatWasNotInViewDoesNotCount) {
  EXPECT_EQ(compared(map_of(kYard), Isometry2d::Identity(), {0, 0}, 1).found, -1);
}

// After a second of looks at the box, the eyes turn away; the report is `later_s` after the last look at it.
nlohmann::ordered_json reported_later(const map::LocalMap& map, double later_s) {
  MapTruth truth({box()});
  for (int i = 0; i < 10; ++i)
    truth.look(from_seconds(0.1 * i), map::test_eye(0, 0.5), vision::test_camera(320, 240));
  Eigen::Isometry3d away = map::test_eye(0, 0.5);
  away.linear() = Eigen::AngleAxisd(2, Eigen::Vector3d::UnitZ()) * away.linear();
  for (int i = 10; 0.1 * i <= 0.9 + later_s; ++i)
    truth.look(from_seconds(0.1 * i), away, vision::test_camera(320, 240));
  const std::vector<Vector2d> none;
  truth.compare({from_seconds(0.9 + later_s), map, {0, 0}, 0, none, none, {1, 0}},
                Isometry2d::Identity());
  return truth.json();
}

TEST(MapTruth, InViewAreThePointsOfTheLastTwoSecondsAlone) {
  const map::LocalMap map = map_of(kYard);
  const auto now = reported_later(map, 1.9), later = reported_later(map, 2.1);
  EXPECT_GT(now["outline_points"], 20);
  EXPECT_EQ(now["outline_points_in_view"], now["outline_points"]);
  EXPECT_EQ(now["outline_found_in_view"], now["outline_found"]);
  EXPECT_EQ(later["outline_points_in_view"], 0);
  EXPECT_EQ(later["outline_found_in_view"], 0);
  // What was seen before still counts among all.
  EXPECT_EQ(later["outline_points"], now["outline_points"]);
  EXPECT_EQ(later["outline_found"], now["outline_found"]);
  EXPECT_EQ(reported_later(map_of({}), 0)["outline_found_in_view"], 0);
}

// In view for less than half a second, but within the last 2 s.
TEST(MapTruth, InViewIsNothingThatWasSeenInPassing) {
  MapTruth truth({box()});
  for (int i = 0; i < 3; ++i)
    truth.look(from_seconds(0.1 * i), map::test_eye(0, 0.5), vision::test_camera(320, 240));
  const std::vector<Vector2d> none;
  truth.compare({from_seconds(0.2), map_of({}), {0, 0}, 0, none, none, {1, 0}},
                Isometry2d::Identity());
  EXPECT_EQ(truth.json()["outline_points_in_view"], 0);
}

}  // namespace
}  // namespace kaz::tools
