// The map of a walking robot, the way ahead on it, and goals as they are typed.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/walking_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "host/behavior/navigation_goal.h"
#include "host/behavior/options.h"
#include "host/map/view_testing.h"
#include "host/motion/gait.h"
#include "shared/base/angle.hpp"
#include "shared/base/random.hpp"

namespace kaz::behavior {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2d;
using map::CellState;

// Box from 0.45 to 0.55 m ahead, 0.05 m right to 0.15 m left.
const map::TestYard kBoxAhead{{{{0.50, 0.05, 0.05}, {0.10, 0.20, 0.10}}}};

map::LocalMap empty_map() {
  return map::LocalMap::make().value();
}

// What a robot in the crouch sees of a yard in its foot frame.
FloorPicture picture(const map::TestYard& yard, std::uint64_t number) {
  map::TestView view = yard.seen(map::test_eye(0, 0.5), 0.1, number);
  const host::JointAngles angles = motion::home();
  view.planes.info.joint_rad.assign(angles.begin(), angles.end());
  return {view.planes, view.depth, nullptr};
}

TEST(PlaceHistory, InterpolatesAndForgets) {
  PlaceHistory places;
  EXPECT_FALSE(places.at(1s));
  places.add(1s, {.x = 0.1, .heading = 0.2});
  places.add(2s, {.x = 0.3, .heading = 0.4});
  places.add(1500ms, {.x = 9});  // comes too late
  EXPECT_FALSE(places.at(999ms));
  EXPECT_NEAR(places.at(1500ms)->x, 0.2, 1e-12);
  EXPECT_NEAR(places.at(1500ms)->heading, 0.3, 1e-12);
  EXPECT_NEAR(places.at(3s)->x, 0.3, 1e-12);
  places.clear();
  EXPECT_FALSE(places.at(1500ms));
}

// A robot at (0.2, -0.1), turned by 30 degrees, sees a box 0.5 m ahead: it stands there in the map.
TEST(WalkingMap, EntersPicturesWhereTheRobotWas) {
  WalkingMap walking(empty_map());
  PlaceHistory places;
  const motion::Place place{.x = 0.2, .y = -0.1, .heading = 30 * kDegree};
  places.add(0s, place);
  for (std::uint64_t k = 1; k <= 3; ++k)
    ASSERT_TRUE(walking.enter({picture(kBoxAhead, k)}, places));
  EXPECT_EQ(walking.entered_since(200ms), 2);
  EXPECT_EQ(walking.newest(), 300ms);
  const host::JointAngles angles = motion::home();
  const auto hips = motion::hips_over_sole(angles, host::supporting_foot(angles));
  const auto at = [&](double ahead, double left) {  // of the sole
    const Vector2d in_map =
        Vector2d(place.x, place.y) +
        Eigen::Rotation2Dd(place.heading) * (Vector2d(ahead, left) - hips.head<2>());
    return walking.map().at(in_map.x(), in_map.y()).state;
  };
  const auto face = [&](double left) {
    bool found = false;
    for (double ahead = 0.45; ahead < 0.475; ahead += 0.004)
      found = found || at(ahead, left) == CellState::obstacle;
    return found;
  };
  for (const double left : {-0.02, 0.05, 0.12}) EXPECT_TRUE(face(left)) << left;
  for (const double left : {-0.1, 0.0, 0.1}) EXPECT_EQ(at(0.40, left), CellState::floor) << left;
  EXPECT_EQ(at(0.7, 0.05), CellState::unknown) << "behind the box";
}

TEST(WalkingMap, LeavesOutPicturesOfWhichThePlaceIsNotKnown) {
  WalkingMap walking(empty_map());
  PlaceHistory places;
  places.add(250ms, {});
  FloorPicture no_posture = picture(kBoxAhead, 3);
  no_posture.planes.info.posture_known = false;
  ASSERT_TRUE(walking.enter({picture(kBoxAhead, 2), no_posture}, places));
  EXPECT_EQ(walking.map().counts().updates, 0U);
  EXPECT_EQ(walking.newest(), 0s);
  ASSERT_TRUE(walking.enter({picture(kBoxAhead, 3), picture(kBoxAhead, 3)}, places));
  EXPECT_EQ(walking.map().counts().updates, 1U) << "the same picture again is none";
}

// What is not seen again while the robot walks on loses its evidence.
TEST(WalkingMap, FadesWhileTheRobotWalks) {
  WalkingMap walking(empty_map());
  PlaceHistory places;
  places.add(0s, {});
  ASSERT_TRUE(walking.enter({picture(kBoxAhead, 1)}, places));
  const double face = 0.458 - motion::hips_over_sole(motion::home(), host::Side::left).x();
  const double before = walking.map().at(face, 0.05).confidence;
  ASSERT_EQ(walking.map().at(face, 0.05).state, CellState::obstacle);
  places.add(1s, {.x = -0.3, .heading = 180 * kDegree});  // it looks away
  ASSERT_TRUE(walking.enter({picture({}, 20)}, places));
  EXPECT_LT(walking.map().at(face, 0.05).confidence, before);
  EXPECT_EQ(walking.map().at(face, 0.05).state, CellState::obstacle);
}

// The picture of a floor with spots of 2 cm.
FloorPicture spotted(const map::TestYard& yard, std::uint64_t number) {
  FloorPicture seen = picture(yard, number);
  const vision::CameraModel& c = seen.planes.info.camera;
  const Eigen::Isometry3d eye = map::test_eye(0, 0.5);
  auto images = std::make_shared<vision::StereoImages>();
  images->left = {c.width, c.height, {}};
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      const Eigen::Vector3d ray =
          eye.linear() * Eigen::Vector3d((u - c.cx) / c.fx, (v - c.cy) / c.fy, 1);
      const Vector2d at = -eye.translation().z() / ray.z() * ray.head<2>();
      const auto spot = [](double m) {
        return static_cast<std::uint64_t>(std::floor(m / 0.02) + 500);
      };
      const double bright = ray.z() < 0 && at.norm() < 5
                                ? 128 + 30 * keyed_normal(3, spot(at.x()), spot(at.y()))
                                : 200;
      images->left.rgb.insert(images->left.rgb.end(), 3,
                              static_cast<std::uint8_t>(std::clamp(bright, 0.0, 255.0)));
    }
  }
  seen.images = std::move(images);
  return seen;
}

// Share of the evidence for the box that is left after a turn by `turned_rad`, in which the eyes leave it;
// where `compares`, the floor's pattern has put the robot's place right before.
double left_after_turn(double turned_rad, bool compares) {
  WalkingMap walking(empty_map());
  PlaceHistory places;
  places.add(0s, {});
  places.add(1s, {});
  EXPECT_TRUE(walking.enter({spotted(kBoxAhead, 1)}, places));
  walking.remember(spotted(kBoxAhead, 1), places);
  if (compares) {
    EXPECT_TRUE(walking.align(spotted(kBoxAhead, 5), places));
  }
  EXPECT_EQ(walking.corrections(), compares ? 1 : 0);
  const int x =
      walking.map().number(0.458 - motion::hips_over_sole(motion::home(), host::Side::left).x());
  const int y = walking.map().number(0.05);
  const double before = walking.map().log_odds(x, y);
  EXPECT_GT(before, 1);
  places.add(1900ms, {.heading = turned_rad});
  EXPECT_TRUE(walking.enter({picture({}, 20)}, places));
  return walking.map().log_odds(x, y) / before;
}

// Where the place is known better, what was seen is kept longer: near to where the floor was compared.
TEST(WalkingMap, FadesMoreSlowlyWhereTheFloorWasCompared) {
  EXPECT_NEAR(left_after_turn(80 * kDegree, false), 0.90, 0.01);
  EXPECT_NEAR(left_after_turn(80 * kDegree, true), 0.95, 0.01);
  EXPECT_NEAR(left_after_turn(100 * kDegree, true), 0.90, 0.01);
}

TEST(LookAhead, EndsAtAnObstacleAndAtWhatIsNotKnown) {
  WalkingMap walking(empty_map());
  PlaceHistory places;
  places.add(0s, {});
  for (std::uint64_t k = 1; k <= 6; ++k)
    ASSERT_TRUE(walking.enter({picture(kBoxAhead, k)}, places));
  const double hips = motion::hips_over_sole(motion::home(), host::Side::left).x();
  const Ahead box = look_ahead(walking.map(), {}, 1.0, true);
  EXPECT_EQ(box.by, Ahead::By::obstacle);
  // The face is at 0.45 m before the sole; 0.08 m of the robot and 0.02 of margin are before the hips.
  EXPECT_NEAR(box.clear_m, 0.45 - hips - 0.08 - 0.02, 0.02);
  const Ahead near = look_ahead(walking.map(), {}, 0.2, true);
  EXPECT_EQ(near.by, Ahead::By::nothing);
  EXPECT_EQ(near.clear_m, 0.2);
  // To the right the floor is free; behind the robot nothing was seen.
  EXPECT_EQ(look_ahead(walking.map(), {.x = 0.3, .y = -0.3}, 0.4, true).by, Ahead::By::nothing);
  const Ahead behind = look_ahead(walking.map(), {.heading = 180 * kDegree}, 0.6, true);
  EXPECT_EQ(behind.by, Ahead::By::unknown);
  EXPECT_LT(behind.clear_m, 0.15);
  EXPECT_EQ(look_ahead(walking.map(), {.heading = 180 * kDegree}, 0.6, false).by,
            Ahead::By::nothing);
}

TEST(NavigationGoal, IsReadAsItIsTyped) {
  const auto place = navigation_goal("0.8,-0.25");
  ASSERT_TRUE(place);
  EXPECT_FALSE(place->ball);
  EXPECT_EQ(place->position, Vector2d(0.8, -0.25));
  EXPECT_FALSE(place->heading_rad);
  EXPECT_NEAR(*navigation_goal("1,0,90")->heading_rad, 90 * kDegree, 1e-12);
  EXPECT_TRUE(navigation_goal("ball")->ball);
  for (const char* bad : {"", "1", "1,", ",1", "1,2,3,4", "balls", "1,nan", "inf,0", "2.5,2.5",
                          "1,0,400", "1 ,0", "ball,1"})
    EXPECT_FALSE(is_navigation_goal(bad)) << bad;
}

TEST(NavigationGoal, IsAnOptionWithASentence) {
  const Option options[] = {
      {"goal", "1,0", "X,Y or ball", 0, 0, "where to", false, is_navigation_goal}};
  EXPECT_EQ(OptionValues::parse(options, {})->choice("goal"), "1,0");
  EXPECT_EQ(OptionValues::parse(options, {{"goal", "ball"}})->choice("goal"), "ball");
  EXPECT_EQ(valid_values(options[0]), "X,Y or ball");
  const auto refused = OptionValues::parse(options, {{"goal", "there"}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "`there` is not a value of the option `goal`: must be X,Y or ball (where to)");
}

}  // namespace
}  // namespace kaz::behavior
