// Batch without Python: the same numbers for any number of threads, and errors.
// SPDX-License-Identifier: Apache-2.0
//
// `./tools/dev study sanitize` runs this under the thread sanitizer.
#include "python/src/batch.h"

#include <gtest/gtest.h>

namespace kaz::python {
namespace {

constexpr int kRobots = 5;

std::unique_ptr<Batch> make(Engine engine, int threads, bool pictures = false) {
  BatchOptions options;
  options.engine = engine;
  options.robots = kRobots;
  options.threads = threads;
  options.settle_ms = 40;
  options.pictures = pictures;
  sim::SimulationOptions& simulation = options.simulation;
  simulation.world_path = "sim/worlds/ball.sdf";
  simulation.robot_path = "shared/robot/kaz/kaz.urdf";
  simulation.camera_path = "shared/robot/kaz/camera.json";
#ifdef KAZ_FIRMWARE_IMAGE
  simulation.image_path = KAZ_FIRMWARE_IMAGE;
#endif
  auto batch = Batch::create(options);
  EXPECT_TRUE(batch) << batch.error().message;
  return batch ? std::move(*batch) : nullptr;
}

// Resets all robots, then two of them again, and steps all but one.
BatchState play(Batch& batch) {
  std::vector<std::optional<std::uint64_t>> seeds(kRobots);
  for (int i = 0; i < kRobots; ++i) seeds[static_cast<std::size_t>(i)] = 1 + i;
  const std::vector<double> targets(kRobots * BatchState::kJoints, 0.1);
  std::vector<std::uint8_t> resting(kRobots, 0);
  EXPECT_TRUE(batch.reset(seeds));
  for (int period = 0; period < 3; ++period) EXPECT_TRUE(batch.step(targets, resting));
  seeds[0] = seeds[3] = std::nullopt;
  EXPECT_TRUE(batch.reset(seeds));
  resting[1] = 1;
  EXPECT_TRUE(batch.push(0, "trunk", {0.05, 0, 0}));
  for (int period = 0; period < 3; ++period) EXPECT_TRUE(batch.step(targets, resting));
  return batch.state();
}

void expect_equal_for_any_threads(Engine engine, bool pictures) {
  const auto alone = make(engine, 1, pictures), together = make(engine, 3, pictures);
  ASSERT_TRUE(alone && together);
  const BatchState one = play(*alone), other = play(*together);
  EXPECT_EQ(one.measured, other.measured);
  EXPECT_EQ(one.inertial, other.inertial);
  EXPECT_EQ(one.trunk, other.trunk);
  EXPECT_EQ(one.ball, other.ball);
  EXPECT_EQ(one.picture_age, other.picture_age);
  for (std::size_t i = 0; i < kRobots; ++i) {
    ASSERT_EQ(alone->pictures(i) != nullptr, pictures) << i;
    if (!pictures) continue;
    EXPECT_EQ(alone->pictures(i)->left.rgb, together->pictures(i)->left.rgb) << i;
    EXPECT_EQ(alone->pictures(i)->right.rgb, together->pictures(i)->right.rgb) << i;
  }
}

TEST(Batch, IsTheSameForAnyNumberOfThreadsWithoutABoard) {
  expect_equal_for_any_threads(Engine::none, false);
}

TEST(Batch, IsTheSameForAnyNumberOfThreadsOnTheNativeBoard) {
  expect_equal_for_any_threads(Engine::native, false);
}

#ifdef KAZ_FIRMWARE_IMAGE
TEST(Batch, IsTheSameForAnyNumberOfThreadsOnTheEmulatedBoard) {
  expect_equal_for_any_threads(Engine::h8, false);
}
#endif

TEST(Batch, DrawsTheSamePicturesForAnyNumberOfThreads) {
  expect_equal_for_any_threads(Engine::native, true);
}

TEST(Batch, StepsNothingBeforeAResetAndKnowsNoOtherRobot) {
  const auto batch = make(Engine::none, 3);
  ASSERT_TRUE(batch);
  const std::vector<double> targets(kRobots * BatchState::kJoints);
  const std::vector<std::uint8_t> resting(kRobots);
  const auto stepped = batch->step(targets, resting);
  ASSERT_FALSE(stepped);
  EXPECT_EQ(stepped.error().fault, Fault::usage);
  EXPECT_FALSE(batch->push(kRobots, "trunk", {0, 0, 0}));
  EXPECT_FALSE(batch->push(-1, "trunk", {0, 0, 0}));
}

}  // namespace
}  // namespace kaz::python
