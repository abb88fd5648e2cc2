// A few runs of the walking behaviours through host, wire and emulated firmware; and the scoring.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/studies/walking/score.h"

namespace kaz::walking {
namespace {

Trial trial(const std::string& name) {
  for (const Trial& one : trials())
    if (one.name == name) return one;
  ADD_FAILURE() << "no trial " << name;
  return trials().front();
}

Outcome run(const Trial& asked, std::uint64_t seed) {
  const auto outcome = run_trial(
      asked, {.engine = "h8", .image_path = KAZ_FIRMWARE_IMAGE, .robot_folder = KAZ_ROBOT}, seed);
  EXPECT_TRUE(outcome) << outcome.error().message;
  const Outcome out = outcome.value_or(Outcome{});
  std::printf("%s, seed %d: %.3f m, aside %.3f m, heading %.2f deg, %.1f s\n", asked.name.c_str(),
              static_cast<int>(seed), out.forward_m, out.aside_m, out.heading_deg, out.seconds);
  return out;
}

// A third of a metre, so that it is short; judged as the table judges a metre.
TEST(Walking, GoesForwardByTheGyro) {
  Trial asked = trial("walk 1 m");
  asked.options["distance"] = "0.3";
  asked.distance = 0.3;
  EXPECT_TRUE(succeeded(asked, run(asked, 1)));
}

TEST(Walking, TurnsByTheGyro) {
  const Trial asked = trial("turn +45, mu 0.6");
  EXPECT_TRUE(succeeded(asked, run(asked, 1)));
}

TEST(Walking, GetsUpFromItsFace) {
  const Outcome out = run(trial("get up, fell ahead"), 1);
  EXPECT_FALSE(out.fell);
}

TEST(Walking, GetsUpFromItsBack) {
  const Outcome out = run(trial("get up, fell back"), 1);
  EXPECT_FALSE(out.fell);
}

// Pushed over in the middle of a walk: the robot itself notices, says so, and is limp.
TEST(Walking, NoticesAFallAndGoesLimp) {
  Trial asked = trial("walk 1 m");
  asked.options["distance"] = "0.3";
  asked.push_ns = 1.5;
  asked.push_every_s = 3;
  asked.push_to_deg = 0;
  asked.to_the_end = true;
  Outcome out = run(asked, 1);
  EXPECT_TRUE(out.fell);
  EXPECT_EQ(out.figures["seen_to_fall"], 1);
  EXPECT_LT(out.figures["current_a"], 1e-6);
}

TEST(Walking, CountsFallsAndMisses) {
  const Trial walk{.distance = 1}, turn{.judged = Judged::turn, .turn_deg = -45};
  EXPECT_TRUE(succeeded(walk, {.forward_m = 0.95, .aside_m = 0.05, .heading_deg = 7}));
  EXPECT_FALSE(succeeded(walk, {.fell = true, .forward_m = 1}));
  EXPECT_FALSE(succeeded(walk, {.forward_m = 1, .heading_deg = -9}));
  EXPECT_FALSE(succeeded(walk, {.forward_m = 0.94, .aside_m = 0.09}));
  EXPECT_TRUE(succeeded(turn, {.heading_deg = -50}));
  EXPECT_FALSE(succeeded(turn, {.heading_deg = 45}));
}

}  // namespace
}  // namespace kaz::walking
