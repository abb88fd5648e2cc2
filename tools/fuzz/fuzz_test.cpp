// The fuzzer on the engines: seeds replayed, short random runs, and the robot's body.
// SPDX-License-Identifier: Apache-2.0
//
// Long runs: `kaz fuzz`, `./tools/dev fuzz` (docs/howto/fuzzing.md).
#include <chrono>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>

#include "hil/fuzz/search.h"
#include "tools/fuzz/engine_case.h"
#include "tools/fuzz/plant.h"

namespace kaz::fuzz {
namespace {

struct Sum {
  long long ticks = 0, replies = 0, refusals = 0;
  double overshoot = 0;
  int worst_busy_8states = 0;
};

void run_one(const hil::fuzz::Genome& genome, const EngineOptions& options, Sum& sum) {
  const auto verdict = run_engine_case(genome, options);
  ASSERT_TRUE(verdict) << verdict.error().message;
  EXPECT_FALSE(verdict->violation)
      << *verdict->violation << "\n"
      << hil::fuzz::text_of(hil::fuzz::events_of(genome, options.grammar));
  sum.ticks += verdict->ticks;
  sum.replies += verdict->counts.replies;
  sum.refusals += verdict->counts.refusals;
  sum.overshoot = std::max(sum.overshoot, verdict->worst_overshoot_rad);
  sum.worst_busy_8states = std::max<int>(sum.worst_busy_8states, verdict->worst_busy_8states);
}

Sum random_cases(const EngineOptions& options, std::uint64_t seed, int cases) {
  Sum sum;
  hil::fuzz::Search search(seed);
  for (int i = 0; i < cases && !testing::Test::HasFailure(); ++i)
    run_one(search.next(), options, sum);
  return sum;
}

TEST(Fuzz, BenchHasTheRobotsDefaultMotor) {
  const auto path = std::filesystem::path(KAZ_ROBOT).replace_filename("motor.xml");
  const auto motor = sim::load_motor_file(path, "");
  ASSERT_TRUE(motor) << motor.error().message;
  EXPECT_EQ(bench_motor(), *motor);
}

TEST(Fuzz, SeedsOnTheNativeEngine) {
  const auto corpus = hil::fuzz::load_corpus(KAZ_FUZZ_SEEDS);
  ASSERT_TRUE(corpus);
  EXPECT_GT(corpus->size(), 10u);
  Sum sum;
  for (const auto& genome : *corpus) run_one(genome, {}, sum);
}

TEST(Fuzz, RandomCasesOnTheNativeEngine) {
  const Sum sum = random_cases({}, 1, 60);
  EXPECT_GT(sum.ticks, 10000);
  EXPECT_GT(sum.replies, 200);
  EXPECT_GT(sum.refusals, 100);
}

TEST(Fuzz, RandomCasesOnTheRobotsBody) {
  EngineOptions options;
  options.world_path = KAZ_WORLD;
  options.robot_path = KAZ_ROBOT;
  options.grammar.faults = false;
  const Sum sum = random_cases(options, 2, 12);
  EXPECT_GT(sum.ticks, 3000);
}

TEST(Fuzz, ACaseIsTheSameEachTime) {
  const hil::fuzz::Genome genome = hil::fuzz::Search(9).next();
  const auto one = run_engine_case(genome, {});
  const auto two = run_engine_case(genome, {});
  ASSERT_TRUE(one);
  ASSERT_TRUE(two);
  EXPECT_EQ(one->features, two->features);
  EXPECT_EQ(one->ticks, two->ticks);
}

TEST(Fuzz, WhatAnInterruptedCaseHasDoneIsKnown) {
  // As early or late as the machine makes it: some of them end within the case.
  const hil::fuzz::Genome genome = hil::fuzz::Search(9).next();
  for (int tenths_ms = 1; tenths_ms < 400; ++tenths_ms) {
    host::Interrupt interrupt;
    EngineVerdict broken_off;
    EngineOptions options;
    options.interrupt = &interrupt;
    options.broken_off = &broken_off;
    const std::jthread signal([&] {
      std::this_thread::sleep_for(std::chrono::microseconds(100 * tenths_ms));
      interrupt.request();
    });
    const auto verdict = run_engine_case(genome, options);
    if (verdict || broken_off.ticks == 0) continue;
    EXPECT_EQ(verdict.error().fault, Fault::interrupted);
    EXPECT_GT(broken_off.counts.requests, 0);
    EXPECT_GT(broken_off.seconds, 0);
    EXPECT_FALSE(broken_off.violation);
    return;
  }
  FAIL() << "no case was interrupted";
}

#ifdef KAZ_FIRMWARE_IMAGE
TEST(Fuzz, RandomCasesOnTheFirmware) {
  EngineOptions options;
  options.mcu = sim::McuKind::h8;
  options.image = KAZ_FIRMWARE_IMAGE;
  const Sum sum = random_cases(options, 3, 8);
  EXPECT_GT(sum.ticks, 2000);
  EXPECT_LT(8 * sum.worst_busy_8states, 18432);
}
#endif

}  // namespace
}  // namespace kaz::fuzz
