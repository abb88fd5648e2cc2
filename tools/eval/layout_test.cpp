// Kinds of worlds: each valid, reachable, the same for the same seed, and with what it is named for.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/layout.h"

#include <cmath>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "host/plan/grid_planner.h"
#include "shared/base/files.hpp"
#include "sim/body/description/world_model.h"
#include "sim/body/world/world.h"
#include "tools/eval/scenario.h"

namespace kaz::tools {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kSeeds = 6;

Scenario scenario_of(WorldKind kind, std::uint64_t seed, Interval density = {0, 1}) {
  Variation variation;
  variation.worlds = {kind};
  variation.density = density;
  Scenario scenario = Scenario::draw(variation, seed, 0);
  const auto drawn = scenario.add_layout(variation, kind == WorldKind::two_balls);
  EXPECT_TRUE(drawn) << drawn.error().message;
  return scenario;
}

class Kind : public testing::TestWithParam<WorldKind> {};

std::vector<WorldKind> every_kind() {
  return parse_world_kinds({"all"}).value();
}
INSTANTIATE_TEST_SUITE_P(All, Kind, testing::ValuesIn(every_kind()), [](const auto& test) {
  std::string name = to_string(test.param);
  std::erase(name, '-');
  return name;
});

TEST_P(Kind, IsTheSameForTheSameSeedAndDiffersByIt) {
  std::set<std::string> worlds;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const std::string text = world_text(scenario_of(GetParam(), seed)).value();
    EXPECT_EQ(text, world_text(scenario_of(GetParam(), seed)).value());
    worlds.insert(text);
  }
  EXPECT_EQ(worlds.size(), kSeeds);
}

// libsdformat and our own checks take it.
TEST_P(Kind, IsAValidWorld) {
  const std::string folder = make_temporary_folder("kaz-worlds-").value();
  const std::string path = folder + "/world.sdf";
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Scenario scenario = scenario_of(GetParam(), seed);
    ASSERT_TRUE(write_whole_file(path, world_text(scenario).value()));
    const auto world = sim::load_world(path);
    ASSERT_TRUE(world) << world.error().message;
    EXPECT_EQ(world->bodies.size(), 1 + scenario.layout.table.size() +
                                        scenario.layout.obstacles.size() +
                                        (scenario.has_ball ? 1 : 0));
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
}

// For a robot of 20 cm, by the search without an estimate, past the true places.
TEST_P(Kind, HasAWayToTheGoal) {
  const auto planner = plan::make_grid_planner(plan::Search::exhaustive);
  const Scenario scenario = scenario_of(GetParam(), 4);
  const Layout& layout = scenario.layout;
  plan::PlanOptions options;
  options.radius_m = 0.20;
  const auto found = planner->plan(true_grid(layout, reach_of(layout)), {},
                                   {layout.goal, layout.goal_heading_rad}, options);
  ASSERT_TRUE(found);
  EXPECT_TRUE(std::holds_alternative<plan::Path>(*found));
  EXPECT_GT(scenario.least_s, 0);
}

TEST_P(Kind, HasADensityWithinTheRequestedRange) {
  for (const Interval density : {Interval{0, 0.1}, {0.9, 1}}) {
    const Scenario scenario = scenario_of(GetParam(), 5, density);
    EXPECT_GE(scenario.layout.density, density.min);
    EXPECT_LE(scenario.layout.density, density.max);
  }
}

// m, that a disc of this radius has between everything on the straight line to the goal; negative: it is
// blocked.
double room_on_the_line(const Layout& layout) {
  double room = 1e9;
  for (const Obstacle& o : layout.obstacles)
    for (double u = 0; u <= 1; u += 0.01)
      room = std::min(room, distance_to(at_rest(o), u * layout.goal));
  return room;
}

TEST(Kinds, AreWhatTheyAreNamedFor) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    for (const WorldKind kind : {WorldKind::slalom, WorldKind::u_trap, WorldKind::low_step,
                                 WorldKind::thin_poles, WorldKind::moving_box})
      EXPECT_LT(room_on_the_line(scenario_of(kind, seed).layout), 0.15) << to_string(kind) << seed;
    for (const Obstacle& o : scenario_of(WorldKind::low_step, seed).layout.obstacles)
      EXPECT_EQ(o.height_m, 0.02);
    for (const Obstacle& o : scenario_of(WorldKind::thin_poles, seed).layout.obstacles)
      EXPECT_EQ(o.length_m, 0.005);
    EXPECT_LT(scenario_of(WorldKind::dark, seed).lamp, 0.13);
    EXPECT_EQ(scenario_of(WorldKind::plain_floor, seed).floor, "plain");
    const Scenario balls = scenario_of(WorldKind::two_balls, seed);
    ASSERT_EQ(balls.layout.obstacles[0].shape, Shape::ball);
    EXPECT_NE(balls.layout.obstacles[0].rgb, ball_color(balls.ball_color)->rgb);
    EXPECT_EQ(Vector2d(balls.ball_x_m, balls.ball_y_m), balls.layout.goal);
  }
}

// Results are published by their seed (docs/results/README.md): clutter of a seed stays what it was.
TEST(Kinds, ClutterIsThatOfThePublishedResults) {
  const Variation variation;
  Scenario scenario = Scenario::draw(variation, 17, 0);
  ASSERT_EQ(scenario.kind, WorldKind::clutter);
  ASSERT_TRUE(scenario.add_layout(variation, false));
  EXPECT_EQ(scenario.layout.obstacles.size(), 6u);
  EXPECT_NEAR(scenario.layout.goal.x(), 0.5339518511319776, 1e-9);
  EXPECT_NEAR(scenario.layout.goal.y(), -1.3888095851540785, 1e-9);
  EXPECT_NEAR(scenario.least_s, 39.87392020190607, 1e-6);
  EXPECT_EQ(scenario.floor, "checker");
}

// Walls are on both sides of the line to the goal.
TEST(Kinds, ACorridorIsNarrowerTheDenserItIs) {
  const auto room = [](double density) {
    Layout layout = scenario_of(WorldKind::corridor, 3, {density, density}).layout;
    layout.obstacles.pop_back();  // the wall behind the goal
    return room_on_the_line(layout);
  };
  EXPECT_NEAR(room(0), 0.40, 0.01);
  EXPECT_NEAR(room(1), 0.25, 0.01);
}

TEST(Kinds, TheStraightWayLeadsOverTheEdgeOfADenseTable) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Layout layout = scenario_of(WorldKind::table_edge, seed, {1, 1}).layout;
    const plan::Grid grid = true_grid(layout, reach_of(layout));
    bool meets_edge = false;
    for (double u = 0; u <= 1; u += 0.01) {
      for (double angle = 0; angle < 6.28; angle += 0.1) {  // with the robot's width
        const Vector2d at = u * layout.goal + 0.15 * Vector2d(std::cos(angle), std::sin(angle));
        const Eigen::Vector2i cell = grid.cell(at);
        meets_edge = meets_edge || grid.at(cell.x(), cell.y()) == map::CellState::obstacle;
      }
    }
    EXPECT_TRUE(meets_edge) << seed;
  }
}

// The push of the world file brings it to where the planner's map has it, and it stays.
TEST(Kinds, TheMovingBoxSlidesToItsPlace) {
  const std::string folder = make_temporary_folder("kaz-worlds-").value();
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    Scenario scenario = scenario_of(WorldKind::moving_box, seed);
    for (Obstacle& o : scenario.layout.obstacles)
      if (o.slide) o.slide->at_s = 0.1;
    const std::string path = folder + "/world.sdf";
    ASSERT_TRUE(write_whole_file(path, world_text(scenario).value()));
    const auto world = sim::World::load(path, "shared/robot/kaz/kaz.urdf", {.hung = true});
    ASSERT_TRUE(world) << world.error().message;
    const Obstacle& box = *scenario.moving();
    const auto place = [&]() -> Vector2d {
      return (*world)->object_position(scenario.name_of(box)).value().head<2>();
    };
    EXPECT_LT((place() - scenario.world_from_start() * box.place()).norm(), 1e-6);
    for (int i = 0; i < 2000; ++i) (*world)->step({}, 0);
    const Vector2d rest = scenario.world_from_start() * at_rest(box).place();
    EXPECT_LT((place() - rest).norm(), 0.02) << seed;
    const Vector2d before = place();
    for (int i = 0; i < 500; ++i) (*world)->step({}, 0);
    EXPECT_LT((place() - before).norm(), 1e-3) << seed;
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
}

TEST(WorldKinds, AreFoundByNameAndNamesTheOthers) {
  EXPECT_EQ(parse_world_kinds({"slalom", "dark"}).value(),
            (std::vector{WorldKind::slalom, WorldKind::dark}));
  EXPECT_GE(every_kind().size(), 12u);
  for (const WorldKindInfo& info : world_kinds()) EXPECT_STREQ(to_string(info.kind), info.name);
  const auto none = parse_world_kinds({"clutter", "maze"});
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("'maze'"), std::string::npos);
  for (const WorldKindInfo& info : world_kinds())
    EXPECT_NE(none.error().message.find(info.name), std::string::npos);
}

TEST(WorldKinds, AreTakenInTurn) {
  Variation variation;
  variation.worlds = {WorldKind::corridor, WorldKind::dark};
  EXPECT_EQ(Scenario::draw(variation, 1, 0).kind, WorldKind::corridor);
  EXPECT_EQ(Scenario::draw(variation, 1, 1).kind, WorldKind::dark);
  EXPECT_EQ(Scenario::draw(variation, 1, 2).kind, WorldKind::corridor);
}

}  // namespace
}  // namespace kaz::tools
