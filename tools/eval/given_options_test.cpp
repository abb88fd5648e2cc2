// Options of `kaz evaluate` that have no effect are refused, and none that has one.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/given_options.h"

#include <gtest/gtest.h>

namespace kaz::tools {
namespace {

using enum WorldKind;

// The sentence against `option`; empty: it is taken.
std::string refused(const std::string& option, std::vector<WorldKind> worlds,
                    const std::string& goal = "") {
  CampaignOptions options;
  options.behavior = "navigate";
  options.variation.worlds = std::move(worlds);
  if (!goal.empty()) options.settings["goal"] = goal;
  const auto checked = check_given(options, {"--episodes", option});
  return checked ? "" : checked.error().message;
}

TEST(GivenOptions, OfNavigateAreRefusedWithOtherBehaviors) {
  CampaignOptions options;
  for (const char* behavior : {"search-ball", "stand", "./wave.so"}) {
    options.behavior = behavior;
    for (const char* option : {"--worlds", "--density", "--obstacles", "--goal-distance"}) {
      const auto checked = check_given(options, {"--seed", option});
      ASSERT_FALSE(checked) << behavior << option;
      EXPECT_EQ(checked.error().fault, Fault::usage);
      EXPECT_EQ(checked.error().message,
                std::string(option) +
                    " is only valid with navigate: leave the option out, or evaluate navigate");
    }
    EXPECT_TRUE(check_given(options, {"--ball-distance", "--radii", "--colors", "--lamp"}));
  }
}

TEST(GivenOptions, ObstaclesAreOfWorldsWithClutter) {
  EXPECT_EQ(refused("--obstacles", {corridor, slalom}),
            "--obstacles is only valid in worlds with clutter: add one of clutter, "
            "patterned-floor, plain-floor, dark, two-balls to --worlds, or leave the option out");
  EXPECT_EQ(refused("--obstacles", {corridor, dark}), "");
  for (const WorldKindInfo& info : world_kinds()) {
    EXPECT_EQ(refused("--density", {info.kind}), "") << info.name;
    // What the option does in a world is what is said of it.
    const auto count = [&](int max) {
      const LayoutRange range{.density = {1, 1}, .max_obstacles = max};
      return draw_layout(info.kind, range, 5, false, {0.5, 0}).obstacles.size();
    };
    EXPECT_EQ(count(2) != count(8), refused("--obstacles", {info.kind}).empty()) << info.name;
  }
}

TEST(GivenOptions, DistancesAreOfWhatIsDrawn) {
  EXPECT_EQ(refused("--goal-distance", {clutter}), "");
  EXPECT_EQ(refused("--goal-distance", {clutter}, "1,0.2"),
            "--goal-distance chooses a random goal, but --set goal=1,0.2 fixes the goal: leave out "
            "one of the two options");
  EXPECT_NE(refused("--goal-distance", {clutter}, "ball"), "");
  EXPECT_NE(refused("--goal-distance", {two_balls}), "");
  EXPECT_EQ(refused("--goal-distance", {two_balls, clutter}), "");
  EXPECT_EQ(refused("--goal-distance", {clutter, corridor}, "ball"), "")
      << "where the corridor ends";
  EXPECT_NE(refused("--ball-distance", {clutter}), "");
  EXPECT_NE(refused("--ball-distance", {corridor}, "ball"), "");
  EXPECT_EQ(refused("--ball-distance", {corridor, clutter}, "ball"), "");
  EXPECT_EQ(refused("--ball-distance", {two_balls}), "");
}

TEST(GivenOptions, BallsAndLightAreOfWorldsThatHaveThem) {
  for (const char* option : {"--radii", "--colors"}) {
    EXPECT_NE(refused(option, {clutter}), "") << option;
    EXPECT_NE(refused(option, {two_balls}, "1,0"), "") << option;
    EXPECT_EQ(refused(option, {clutter}, "ball"), "") << option;
    EXPECT_EQ(refused(option, {clutter, two_balls}), "") << option;
  }
  EXPECT_EQ(refused("--lamp", {dark}),
            "--lamp has no effect in world dark, which has its own light: leave the option out");
  EXPECT_EQ(refused("--shade", {dark, clutter}), "");
  EXPECT_EQ(refused("--bearing", {clutter}), "");
}

}  // namespace
}  // namespace kaz::tools
