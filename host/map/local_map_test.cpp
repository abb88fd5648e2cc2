// The local map from depth images made of rays: what it shows, and what must not change it.
// SPDX-License-Identifier: Apache-2.0
#include "host/map/local_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/map/view_testing.h"

namespace kaz::map {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

LocalMap make(const LocalMapOptions& options = {}) {
  return LocalMap::make(options).value();
}

void enter(LocalMap& map, const TestView& view,
           const Isometry3d& map_from_foot = Isometry3d::Identity()) {
  const auto done = map.update(view.planes, view.depth, view.depth.info, map_from_foot);
  ASSERT_TRUE(done) << done.error().message;
}

bool same(const LocalMap& a, const LocalMap& b) {
  for (int x = 0; x < a.cells(); ++x) {
    for (int y = 0; y < a.cells(); ++y) {
      if (a.log_odds(x, y) != b.log_odds(x, y)) return false;
    }
  }
  return true;
}

int known(const LocalMap& map) {
  int n = 0;
  for (int x = 0; x < map.cells(); ++x) {
    for (int y = 0; y < map.cells(); ++y) n += map.cell(x, y).state != CellState::unknown ? 1 : 0;
  }
  return n;
}

const TestYard kBoxAhead{{{{0.50, 0.05, 0.05}, {0.10, 0.20, 0.10}}}};

// Box from 0.45 to 0.55 m ahead, 0.05 m right to 0.15 m left.
TEST(LocalMap, ShowsFloorABoxAndNothingOfWhatTheBoxHides) {
  LocalMap map = make();
  for (std::uint64_t k = 1; k <= 3; ++k) enter(map, kBoxAhead.seen(test_eye(0, 0.5), 0.1, k));
  for (const double y : {-0.2, -0.1, -0.06, 0.0, 0.1, 0.16, 0.25})
    EXPECT_EQ(map.at(0.35, y).state, CellState::floor) << y;
  EXPECT_EQ(map.at(0.445, 0.05).state, CellState::floor);
  for (const double y : {-0.03, 0.0, 0.05, 0.1})
    EXPECT_EQ(map.at(0.455, y).state, CellState::obstacle) << y;
  EXPECT_EQ(map.at(0.5, 0.05).state, CellState::obstacle);  // its top
  // Its top edge at 0.55 m is seen from 0.27 m: up to 0.55 * 0.27 / 0.17 = 0.87 m all is hidden.
  for (double x = 0.57; x < 0.86; x += 0.02)
    EXPECT_EQ(map.at(x, 0.05).state, CellState::unknown) << x;
  EXPECT_EQ(map.at(0.95, 0.05).state, CellState::floor);
  EXPECT_EQ(map.at(-0.3, 0).state, CellState::unknown);
  EXPECT_EQ(map.at(9, 9).state, CellState::unknown);
  EXPECT_EQ(map.counts().updates, 3U);
}

// What pictures from one place took for floor, many times, a few pictures from nearer take back.
TEST(LocalMap, FloorSeenOftenDoesNotOutlastAFewPicturesOfWhatStandsThere) {
  LocalMap map = make();
  std::uint64_t number = 0;
  while (number < 40) enter(map, TestYard{}.seen(test_eye(0, 0.5), 0.1, ++number));
  EXPECT_EQ(map.at(0.455, 0.05).state, CellState::floor);
  EXPECT_GT(map.at(0.455, 0.05).confidence, 0.9);
  for (int k = 0; k < 4; ++k) enter(map, kBoxAhead.seen(test_eye(0, 0.5), 0.1, ++number));
  for (const double y : {0.0, 0.05, 0.1})
    EXPECT_EQ(map.certain_at(0.455, y), CellState::obstacle) << y;
}

// What stands beside the feet cannot be distinguished from the robot's own body: a picture without it is no
// evidence that it is gone. Farther away it is.
TEST(LocalMap, ForgetsNothingThatStandsBesideTheFeet) {
  LocalMapOptions options;
  options.own_m = 0.25;
  LocalMap map = LocalMap::make(options).value();
  const TestYard rod{{{{0.50, 0.0, 0.1}, {0.02, 0.02, 0.2}}}};
  const Isometry3d eye = test_eye(0, 0.6);
  std::uint64_t number = 0;
  const auto enter = [&](const TestYard& yard, double foot_x) {
    const TestView view = yard.seen(eye, 0.1, ++number);
    Isometry3d foot = Isometry3d::Identity();
    foot.translation().x() = foot_x;
    ASSERT_TRUE(map.update(view.planes, view.depth, view.depth.info, foot));
  };
  for (int k = 0; k < 12; ++k) enter(rod, 0);
  ASSERT_EQ(map.at(0.495, 0).state, CellState::obstacle);
  for (int k = 0; k < 40; ++k) enter({}, 0.27);
  EXPECT_EQ(map.at(0.495, 0).state, CellState::obstacle) << "0.23 m away";
  EXPECT_EQ(map.at(0.60, 0.1).state, CellState::floor);
  for (int k = 0; k < 40; ++k) enter({}, 0.20);
  EXPECT_EQ(map.at(0.495, 0).state, CellState::floor) << "0.30 m away";
}

// Each cell whose middle is in view, and not at its sides, is known: none is left out where a pixel is larger
// than a cell. What a side cuts off a thing may be called floor.
TEST(LocalMap, HasNoHolesInTheFloorFarAway) {
  for (const int width : {160, 320, 640}) {
    LocalMap map = make();
    const TestView view = TestYard{}.seen(test_eye(0.3, 0.45), 0, 1, width);
    enter(map, view);
    const vision::CameraModel& c = view.depth.info.camera;
    int in_view = 0;
    for (int x = 0; x < map.cells(); ++x) {
      for (int y = 0; y < map.cells(); ++y) {
        const Vector3d at(map.middle(x), map.middle(y), 0);
        const Vector3d p = view.depth.info.foot_from_eye.inverse() * at;
        const double u = c.fx * p.x() / p.z() + c.cx, v = c.fy * p.y() / p.z() + c.cy;
        const double left = width / 20.0 - 0.5, right = width - width / 20.0 - 0.5;
        const bool visible = p.z() > 0.03 && u > left && v > -0.5 && u < right &&
                             v < c.height - 0.5 && at.norm() < 1.5;
        const double edge = std::min(std::min(std::abs(u - left), std::abs(v + 0.5)),
                                     std::min(std::abs(u - right), std::abs(v - c.height + 0.5)));
        if (edge < 2e-3 || std::abs(at.norm() - 1.5) < 1e-6) continue;  // of single precision
        EXPECT_EQ(map.log_odds(x, y) < 0, visible) << width << ": " << at.transpose();
        in_view += visible ? 1 : 0;
      }
    }
    EXPECT_GT(in_view, 5000);
  }
}

TEST(LocalMap, EdgesAreWithinACellFromAnySideAndWithNoise) {
  for (const double pan : {-0.5, 0.0, 0.4}) {
    LocalMap map = make();
    for (std::uint64_t k = 1; k <= 8; ++k)
      enter(map, kBoxAhead.seen(test_eye(pan, 0.5), 0.2, k, 640));
    for (double y = -0.045; y < 0.15; y += 0.01) {
      const Vector3d p = test_eye(pan, 0.5).inverse() * Vector3d(0.45, y, 0);
      if (std::abs(p.x()) > 0.7 * p.z()) continue;  // out of view, or at its side
      double x = 0.35;
      while (map.at(x, y).state == CellState::floor) x += 0.001;
      EXPECT_NEAR(x, 0.45, 0.01) << pan << " " << y;
    }
  }
}

// A face of one colour: no depth but within half a block of its edges, 10 px, and of the rim.
void make_plain(TestView& view, const Isometry3d& eye, double face_x, double from_y, double to_y) {
  const vision::CameraModel& c = view.depth.info.camera;
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      float& d = view.depth.disparity_px[static_cast<std::size_t>(v * c.width + u)];
      const double z = c.fx * c.baseline_m / static_cast<double>(d), edge = 10 * z / c.fx;
      const Vector3d p = eye * (z * Vector3d((u - c.cx) / c.fx, (v - c.cy) / c.fy, 1));
      const bool inside = std::abs(p.x() - face_x) < 0.005 && p.y() > from_y + edge &&
                          p.y() < to_y - edge && p.z() > 0;
      if (inside) d = 0;
    }
  }
}

TEST(LocalMap, APlainFaceStandsBetweenItsEdges) {
  LocalMap map = make();
  for (std::uint64_t k = 1; k <= 3; ++k) {
    TestView view = kBoxAhead.seen(test_eye(0, 0.5), 0, k);
    make_plain(view, test_eye(0, 0.5), 0.45, -0.05, 0.15);
    enter(map, view);
  }
  for (double y = -0.04; y < 0.145; y += 0.01)
    EXPECT_EQ(map.at(0.455, y).state, CellState::obstacle) << y;
}

// The floor from from_x to to_x behind the box is not called floor, and seems nearer by this share of its
// depth: what block matching makes of a rim and the floor behind it.
void mix_behind(TestView& view, const Isometry3d& eye, double from_x, double to_x, double nearer) {
  const vision::CameraModel& c = view.depth.info.camera;
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      const auto pixel = static_cast<std::size_t>(v * c.width + u);
      float& d = view.depth.disparity_px[pixel];
      const double z = c.fx * c.baseline_m / static_cast<double>(d);
      const Vector3d p = eye * (z * Vector3d((u - c.cx) / c.fx, (v - c.cy) / c.fy, 1));
      if (view.planes.label[pixel] != 1 || p.x() < from_x || p.x() > to_x || p.y() < -0.02 ||
          p.y() > 0.12)
        continue;
      view.planes.label[pixel] = 0;
      d = static_cast<float>(d / (1 - nearer));
    }
  }
}

// The box's rim hides the floor from 0.55 to 0.87 m; beyond it a strip has depths between.
TEST(LocalMap, DepthThatARimMixesWithTheFloorBehindItIsNoObstacle) {
  LocalMap map = make();
  for (std::uint64_t k = 1; k <= 3; ++k) {
    TestView view = kBoxAhead.seen(test_eye(0, 0.5), 0, k);
    mix_behind(view, test_eye(0, 0.5), 0.87, 1.05, 0.25);
    enter(map, view);
  }
  EXPECT_EQ(map.at(0.455, 0.05).state, CellState::obstacle);
  for (double x = 0.57; x < 1; x += 0.01) {
    for (double y = -0.05; y < 0.15; y += 0.01)
      EXPECT_NE(map.at(x, y).state, CellState::obstacle) << x << " " << y;
  }
}

// Its foot is hidden by the box, but it is higher.
TEST(LocalMap, AHigherThingBehindALowerOneIsAnObstacle) {
  TestYard yard = kBoxAhead;
  yard.boxes.push_back({{0.75, 0.05, 0.10}, {0.06, 0.20, 0.20}});
  LocalMap map = make();
  for (std::uint64_t k = 1; k <= 3; ++k) enter(map, yard.seen(test_eye(0, 0.3), 0.1, k));
  for (const double y : {-0.03, 0.05, 0.12})
    EXPECT_EQ(map.at(0.725, y).state, CellState::obstacle) << y;
}

// Two posts, whose depth is of their edges as well, and floor between them that is not seen from some
// distance on, raggedly: no face. The gap stays unknown.
TEST(LocalMap, FloorThatEndsRaggedlyBetweenTwoThingsIsNoFace) {
  const TestYard posts{
      {{{0.70, 0.10, 0.1}, {0.04, 0.04, 0.2}}, {{0.70, -0.10, 0.1}, {0.04, 0.04, 0.2}}}};
  LocalMap map = make();
  for (std::uint64_t k = 1; k <= 3; ++k) {
    TestView view = posts.seen(test_eye(0, 0.35), 0, k);
    const vision::CameraModel& c = view.depth.info.camera;
    for (int v = 0; v < c.height; ++v) {
      for (int u = 0; u < c.width; ++u) {
        const auto pixel = static_cast<std::size_t>(v * c.width + u);
        const Vector3d ray =
            test_eye(0, 0.35).linear() * Vector3d((u - c.cx) / c.fx, (v - c.cy) / c.fy, 1);
        const double floor_x = ray.z() < 0 ? 0.27 / -ray.z() * ray.x() : 9;
        const bool floor = view.planes.label[pixel] == 1;
        if (floor && floor_x > 0.68 + 0.03 * std::sin(u * 0.9))
          view.planes.label[pixel] = 0, view.depth.disparity_px[pixel] = 0;
      }
    }
    enter(map, view);
  }
  EXPECT_EQ(map.at(0.685, 0.10).state, CellState::obstacle);
  for (double x = 0.66; x < 0.80; x += 0.01) {
    for (double y = -0.06; y < 0.065; y += 0.01)
      EXPECT_NE(map.at(x, y).state, CellState::obstacle) << x << " " << y;
  }
}

// The posture says that the eye looks a degree higher and is 1 cm lower than it does: the floor's plane in
// the picture says otherwise.
TEST(LocalMap, LevelsTheEyeByTheFloor) {
  Isometry3d wrong = test_eye(0, 0.5 - 0.0175);
  wrong.translation().z() -= 0.01;
  LocalMap right = make(), leveled = make();
  for (std::uint64_t k = 1; k <= 3; ++k) {
    TestView view = kBoxAhead.seen(test_eye(0, 0.5), 0.1, k);
    enter(right, view);
    view.planes.info.foot_from_eye = view.depth.info.foot_from_eye = wrong;
    enter(leveled, view);
  }
  int differ = 0;
  for (int x = 0; x < right.cells(); ++x) {
    for (int y = 0; y < right.cells(); ++y)
      differ += right.cell(x, y).state != leveled.cell(x, y).state ? 1 : 0;
  }
  EXPECT_GT(known(right), 3000);
  EXPECT_LE(differ, 10);
}

TEST(LocalMap, TakesWhatIsAboveTheFloorForAnObstacleAlsoWhereFloorIsSeenBelow) {
  // A board over the floor, 8 to 10 cm high: what is under its front edge is seen by both.
  const TestYard yard{{{{0.55, 0, 0.09}, {0.30, 0.4, 0.02}}}};
  LocalMap map = make();
  for (std::uint64_t k = 1; k <= 3; ++k) enter(map, yard.seen(test_eye(0, 0.5), 0.1, k));
  EXPECT_EQ(map.at(0.425, 0).state, CellState::obstacle);
  EXPECT_EQ(map.at(0.45, 0).state, CellState::obstacle);
  EXPECT_EQ(map.at(0.38, 0).state, CellState::floor);
}

TEST(LocalMap, IgnoresWhatIsLowHighOrTheRobotsOwn) {
  const TestYard yard{{{{0.40, 0, 0.005}, {0.1, 0.3, 0.01}},       // a mat of 1 cm
                       {{0.70, 0, 0.45}, {0.05, 0.6, 0.1}},        // a beam from 0.40 m up
                       {{0.09, 0.03, 0.05}, {0.04, 0.04, 0.1}}}};  // a knee
  LocalMap map = make();
  enter(map, yard.seen(test_eye(0, 0.2)));
  enter(map, yard.seen(test_eye(0, 0.8), 0, 2));
  EXPECT_GT(known(map), 1000);
  for (int x = 0; x < map.cells(); ++x) {
    for (int y = 0; y < map.cells(); ++y)
      ASSERT_NE(map.cell(x, y).state, CellState::obstacle) << map.middle(x) << " " << map.middle(y);
  }
}

// A step of 2 cm agrees with the sole within what vision allows, and its top is called floor.
// An arm at the place of the box: its pixels are no obstacle; the other box, farther aside, is one.
TEST(LocalMap, DoesNotTakeTheRobotsLimbsForObstacles) {
  TestYard yard = kBoxAhead;
  yard.boxes.push_back({{0.60, -0.30, 0.05}, {0.10, 0.10, 0.10}});
  const TestView view = yard.seen(test_eye(0, 0.5), 0.1);
  const auto obstacles = [&](std::span<const OwnPart> own) {
    LocalMap map = make();
    EXPECT_TRUE(map.update(view.planes, view.depth, view.depth.info, Isometry3d::Identity(), own));
    std::pair<int, int> near_far{0, 0};
    for (int x = 0; x < map.cells(); ++x) {
      for (int y = 0; y < map.cells(); ++y) {
        if (map.cell(x, y).state != CellState::obstacle) continue;
        (map.middle(y) > -0.2 ? near_far.first : near_far.second) += 1;
      }
    }
    return near_far;
  };
  const auto [without_near, without_far] = obstacles({});
  EXPECT_GT(without_near, 50);
  EXPECT_GT(without_far, 20);
  const OwnPart arm{{0.5, -0.04, 0.05}, {0.5, 0.14, 0.05}, 0.08};
  const auto [near, far] = obstacles({&arm, 1});
  EXPECT_EQ(near, 0);
  EXPECT_EQ(far, without_far);
  const OwnPart behind{{-0.5, 0, 0.05}, {-0.4, 0, 0.05}, 0.08};
  EXPECT_EQ(obstacles({&behind, 1}), std::pair(without_near, without_far)) << "not in view";
}

TEST(LocalMap, TakesALowStepForAnObstacleThoughItsTopIsCalledFloor) {
  const TestYard yard{{{{0.50, 0, 0.01}, {0.10, 0.20, 0.02}}}};
  LocalMap map = make();
  for (std::uint64_t number = 1; number <= 3; ++number) {
    const Isometry3d eye = test_eye(0, 0.5 + 0.02 * static_cast<double>(number));
    TestView view = yard.seen(eye, 0.05, number);
    vision::PlaneSegment top = view.planes.segments[0];
    top.middle = eye.inverse() * Vector3d(0.5, 0, 0.02);
    view.planes.segments.push_back(top);
    for (std::size_t k = 0; k < view.planes.label.size(); ++k) {
      if (view.planes.label[k] == 0 && view.depth.disparity_px[k] > 0) view.planes.label[k] = 2;
    }
    enter(map, view);
  }
  EXPECT_EQ(map.at(0.5, 0.05).state, CellState::obstacle);
  EXPECT_EQ(map.at(0.4, 0.05).state, CellState::floor);
}

TEST(LocalMap, TrustsFarThingsLess) {
  LocalMap map = make();
  enter(map, TestYard{}.seen(test_eye(0, 0.4)));
  EXPECT_GT(map.at(0.4, 0).confidence, 1.2 * map.at(1.2, 0).confidence);
  EXPECT_GT(map.at(1.2, 0).confidence, 0);
  const double before = map.at(0.4, 0).confidence;
  enter(map, TestYard{}.seen(test_eye(0, 0.4), 0, 2));
  EXPECT_GT(map.at(0.4, 0).confidence, before);
}

// The same views under other numbers: the order of times is given, that of contents is not. Five votes for
// floor are as many as count.
TEST(LocalMap, IsTheSameInAnyOrderOfUpdates) {
  std::vector<TestView> views;
  for (std::uint64_t k = 0; k < 5; ++k)
    views.push_back(kBoxAhead.seen(
        test_eye(0.5 * keyed_normal(3, k, 0), 0.5 + 0.1 * keyed_normal(3, k, 1)), 0.15, k + 1));
  LocalMap there = make(), back = make(), mixed = make();
  const auto enter_as = [&](LocalMap& map, std::size_t which, std::uint64_t number) {
    TestView s = views[which];
    s.planes.info.exposure = s.depth.info.exposure = Time(number);
    enter(map, s);
  };
  for (std::size_t k = 0; k < 5; ++k) {
    enter_as(there, k, k + 1);
    enter_as(back, 4 - k, k + 1);
    enter_as(mixed, (3 * k + 2) % 5, k + 1);
  }
  EXPECT_GT(known(there), 2500);
  EXPECT_TRUE(same(there, back));
  EXPECT_TRUE(same(there, mixed));
}

// Whole cells and quarter turns move cells onto cells. Rounding decides which pixel shows a cell
// whose middle falls between two: one in a thousand may differ there.
TEST(LocalMap, MovesWithTheFoot) {
  const TestView view = kBoxAhead.seen(test_eye(0.2, 0.5), 0.1);
  LocalMap still = make(), moved = make(), turned = make();
  enter(still, view);
  Isometry3d step = Isometry3d::Identity();
  step.translation() << 0.25, -0.13, 0;
  enter(moved, view, step);
  Isometry3d turn = Isometry3d::Identity();
  turn.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // 90 degrees to the left: x, y go to -y, x
  enter(turned, view, turn);
  int differ = 0;
  for (int x = 30; x < still.cells() - 30; ++x) {
    for (int y = 30; y < still.cells() - 30; ++y) {
      const double here = still.log_odds(x, y);
      differ += std::abs(moved.log_odds(x + 25, y - 13) - here) > 0.02 ? 1 : 0;
      differ += std::abs(turned.log_odds(still.cells() - 1 - y, x) - here) > 0.02 ? 1 : 0;
    }
  }
  EXPECT_GT(known(still), 3000);
  EXPECT_LT(differ, known(still) / 500);
}

TEST(LocalMap, RefusesWhatItCannotPlaceAndStaysAsItIs) {
  LocalMap map = make();
  const TestView good = kBoxAhead.seen(test_eye(0, 0.5), 0, 5);
  enter(map, good);
  const LocalMap before = map;
  const auto refuses = [&](auto&& spoil) {
    TestView s = kBoxAhead.seen(test_eye(0.2, 0.5), 0, 6);
    Isometry3d foot = Isometry3d::Identity();
    spoil(s, foot);
    const auto done = map.update(s.planes, s.depth, s.depth.info, foot);
    EXPECT_FALSE(done);
    EXPECT_TRUE(same(map, before));
    EXPECT_EQ(map.counts().updates, 1U);
    return done ? std::string() : done.error().message;
  };
  EXPECT_NE(refuses([](TestView& s, auto&) { s.depth.info.posture_known = false; }).find("posture"),
            std::string::npos);
  EXPECT_EQ(map.counts().without_posture, 1U);
  for (const Time late : {Time(0), good.depth.info.exposure})
    refuses([&](TestView& s, auto&) { s.depth.info.exposure = s.planes.info.exposure = late; });
  EXPECT_EQ(map.counts().out_of_order, 2U);
  refuses([](TestView& s, auto&) { s.planes.info.exposure += Time(1); });
  refuses([](TestView& s, auto&) { s.planes.label.pop_back(); });
  refuses([](TestView& s, auto&) { s.planes.label[7] = 9; });
  refuses([](TestView& s, auto&) { s.depth.width = 0; });
  refuses([](TestView& s, auto&) { s.depth.info.camera.baseline_m = 0; });
  refuses([](TestView& s, auto&) { s.depth.info.camera.width = 640; });
  refuses([](TestView&, Isometry3d& foot) { foot.translation().x() = std::nan(""); });
  enter(map, kBoxAhead.seen(test_eye(0, 0.5), 0, 6));  // and goes on
  map.clear();
  EXPECT_EQ(known(map), 0);
  enter(map, good);
  EXPECT_TRUE(same(map, before));
}

TEST(LocalMap, SurvivesDepthsOfAnySize) {
  LocalMap map = make();
  TestView s = kBoxAhead.seen(test_eye(0, 0.5));
  const float odd[] = {std::nanf(""), INFINITY, -INFINITY, -3.0F, 1e-30F, 1e30F, 0.0F};
  for (std::size_t k = 0; k < s.depth.disparity_px.size(); ++k) {
    s.depth.disparity_px[k] = odd[k % 7];
    s.planes.label[k] = 0;
  }
  enter(map, s);
  EXPECT_EQ(known(map), 0);
}

TEST(LocalMap, ReportsWhetherAFootprintIsFree) {
  LocalMap map = make();
  for (std::uint64_t k = 1; k <= 3; ++k) enter(map, kBoxAhead.seen(test_eye(0, 0.5), 0, k));
  const auto at = [&](double x, double y, double turn, double length = 0.10) {
    return map.footprint(Eigen::Translation2d(x, y) * Eigen::Rotation2Dd(turn), length, 0.06);
  };
  EXPECT_EQ(at(0.36, 0, 0), Footprint::free);
  EXPECT_EQ(at(0.36, 0, 1.2), Footprint::free);
  EXPECT_EQ(at(0.42, 0, 0), Footprint::blocked);
  EXPECT_EQ(at(0.42, 0, M_PI / 2), Footprint::free);  // sideways it fits before the box
  EXPECT_EQ(at(-0.5, 0, 0), Footprint::unknown);
  EXPECT_EQ(at(2.0, 0, 0), Footprint::unknown);
  EXPECT_EQ(map.footprint(Eigen::Isometry2d(Eigen::Translation2d(0.361, 0.001)), 1e-3, 1e-3),
            Footprint::free);
}

TEST(LocalMap, IsDrawnWithForwardUp) {
  LocalMap map = make();
  enter(map, kBoxAhead.seen(test_eye(0, 0.5)));
  const vision::Image image = map.picture();
  ASSERT_EQ(image.width, map.cells());
  const auto pixel = [&](double x, double y) {
    const int row = map.cells() - 1 - map.number(x), column = map.cells() - 1 - map.number(y);
    return &image.rgb[3 * static_cast<std::size_t>(row * image.width + column)];
  };
  EXPECT_GT(pixel(0.35, 0.2)[1], pixel(0.35, 0.2)[0]);    // green
  EXPECT_GT(pixel(0.455, 0.1)[0], pixel(0.455, 0.1)[1]);  // red, left of the middle
  EXPECT_EQ(pixel(-1, 0)[0], 150);
  EXPECT_LT(map.cells() - 1 - map.number(0.5), map.cells() / 2);
}

TEST(LocalMap, RefusesOptionsThatMakeNoMap) {
  for (const auto& spoil :
       {+[](LocalMapOptions& o) { o.cell_m = 0; }, +[](LocalMapOptions& o) { o.size_m = 1e6; },
        +[](LocalMapOptions& o) { o.size_m = std::nan(""); },
        +[](LocalMapOptions& o) { o.disparity_error_px = -1; },
        +[](LocalMapOptions& o) { o.robot_m = 0.01; }}) {
    LocalMapOptions options;
    spoil(options);
    EXPECT_FALSE(LocalMap::make(options));
  }
}

}  // namespace
}  // namespace kaz::map
