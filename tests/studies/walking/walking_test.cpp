// A few episodes of the walking behaviors through host, wire and emulated firmware; and the scoring.
// SPDX-License-Identifier: Apache-2.0
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

Outcome run(const Trial& variant, std::uint64_t seed) {
  const auto outcome = run_trial(
      variant,
      {.mcu = sim::McuKind::h8, .image_path = KAZ_FIRMWARE_IMAGE, .robot_folder = KAZ_ROBOT}, seed);
  EXPECT_TRUE(outcome) << outcome.error().message;
  const Outcome out = outcome.value_or(Outcome{});
  std::printf("%s, seed %d: %.3f m, aside %.3f m, heading %.2f deg, %.1f s\n", variant.name.c_str(),
              static_cast<int>(seed), out.forward_m, out.aside_m, out.heading_deg, out.seconds);
  return out;
}

// 0.3 m instead of 1 m, for speed; the same criterion.
TEST(Walking, GoesForwardByTheGyro) {
  Trial variant = trial("walk 1 m");
  variant.options["distance"] = "0.3";
  variant.distance = 0.3;
  EXPECT_TRUE(succeeded(variant, run(variant, 1)));
}

TEST(Walking, TurnsByTheGyro) {
  const Trial variant = trial("turn +45, mu 0.6");
  EXPECT_TRUE(succeeded(variant, run(variant, 1)));
}

TEST(Walking, GetsUpFromItsFace) {
  const Outcome out = run(trial("get up, fell ahead"), 1);
  EXPECT_FALSE(out.fell);
}

TEST(Walking, GetsUpFromItsBack) {
  const Outcome out = run(trial("get up, fell back"), 1);
  EXPECT_FALSE(out.fell);
}

// Pushed over while walking: the behavior detects the fall, reports it and switches the motors off.
TEST(Walking, DetectsAFallAndGoesLimp) {
  Trial variant = trial("walk 1 m");
  variant.options["distance"] = "0.3";
  variant.push_ns = 1.5;
  variant.push_every_s = 3;
  variant.push_to_deg = 0;
  variant.to_the_end = true;
  Outcome out = run(variant, 1);
  EXPECT_TRUE(out.fell);
  EXPECT_EQ(out.reported["fall_detected"], 1);
  EXPECT_LT(out.reported["current_a"], 1e-6);
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
