// Executors and the ball finder on them: delivery times, order, dropping, failure, shutdown.
// SPDX-License-Identifier: Apache-2.0
#include "vision/pipeline.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "vision/ball_finder.h"
#include "vision/test_pictures.h"

namespace kaz::vision {
namespace {

using std::chrono::milliseconds;

std::shared_ptr<const StereoImages> ball_images(double u) {
  const CameraModel camera = test_camera();
  auto images = std::make_shared<StereoImages>();
  images->left = plain_picture(320, 240, kTestGrey);
  const Eigen::Vector3d at((u - camera.cx) / camera.fx * 0.4, 0, 0.4);
  paint_sphere(images->left, camera, at, 0.020, kTestRed);
  images->right = images->left;
  return images;
}

StereoPair pair_at(std::uint64_t sequence, Time exposure) {
  StereoPair pair;
  pair.info = test_info(test_camera());
  pair.info.sequence = sequence;
  pair.info.exposure = exposure;
  pair.info.posture_known = true;
  pair.info.joint_rad = {0.1 * static_cast<double>(sequence), -0.2};
  return pair;
}

StereoPair pair_with(std::uint64_t sequence, Time exposure,
                     std::shared_ptr<const StereoImages> images) {
  StereoPair pair = pair_at(sequence, exposure);
  std::promise<std::shared_ptr<const StereoImages>> promise;
  promise.set_value(std::move(images));
  pair.images = promise.get_future().share();
  return pair;
}

// Until `done` or 10 s have gone by.
template <class Done>
bool wait_until(Done done) {
  for (int i = 0; i < 10000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return false;
}

BallFinderOptions with_latencies() {
  BallFinderOptions options;
  options.camera_latency = milliseconds(20);
  options.latency = milliseconds(5);
  return options;
}

TEST(Lockstep, DeliversExactlyWhenDue) {
  const auto executor = make_lockstep_executor();
  BallFinder finder(*executor, with_latencies());
  finder.submit(pair_with(1, milliseconds(100), ball_images(160)));
  std::this_thread::sleep_for(milliseconds(30));  // done long before, and yet
  EXPECT_TRUE(finder.poll(milliseconds(100)).empty());
  EXPECT_TRUE(finder.poll(milliseconds(125) - Time(1)).empty());
  const auto ready = finder.poll(milliseconds(125));
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_TRUE(ready[0].found);
  EXPECT_NEAR(ready[0].center_u, 160, 0.1);
  EXPECT_TRUE(finder.poll(milliseconds(1000)).empty());
}

TEST(Lockstep, WaitsForPixelsThatAreLate) {
  const auto executor = make_lockstep_executor();
  BallFinder finder(*executor, with_latencies());
  std::promise<std::shared_ptr<const StereoImages>> promise;
  StereoPair pair = pair_at(7, milliseconds(0));
  pair.images = promise.get_future().share();
  finder.submit(std::move(pair));  // does not wait
  EXPECT_TRUE(finder.poll(milliseconds(24)).empty());
  std::jthread renderer([&] {
    std::this_thread::sleep_for(milliseconds(40));
    promise.set_value(ball_images(100));
  });
  const auto ready = finder.poll(milliseconds(25));
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_NEAR(ready[0].center_u, 100, 0.1);
}

TEST(Lockstep, FrameInformationTravelsWithItsResult) {
  const auto executor = make_lockstep_executor();
  BallFinder finder(*executor, with_latencies());
  constexpr std::uint64_t kFrames = 12;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const double u = 60 + 15.0 * static_cast<double>(i);
    finder.submit(pair_with(i, milliseconds(33 * i), ball_images(u)));
  }
  const auto ready = finder.poll(milliseconds(10000));
  ASSERT_EQ(ready.size(), kFrames);
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    EXPECT_EQ(ready[i].info.sequence, i);
    EXPECT_EQ(ready[i].info.exposure, milliseconds(33 * i));
    EXPECT_TRUE(ready[i].info.posture_known);
    EXPECT_DOUBLE_EQ(ready[i].info.joint_rad.at(0), 0.1 * static_cast<double>(i));
    ASSERT_TRUE(ready[i].found);
    EXPECT_NEAR(ready[i].center_u, 60 + 15.0 * static_cast<double>(i), 0.15);  // no mixing
  }
}

TEST(Lockstep, TwoModulesOnOneExecutorKeepApart) {
  const auto executor = make_lockstep_executor();
  BallFinderOptions slow = with_latencies();
  slow.latency = milliseconds(30);
  BallFinder fast_finder(*executor, with_latencies()), slow_finder(*executor, slow);
  for (BallFinder* finder : {&fast_finder, &slow_finder}) {
    finder->submit(pair_with(1, milliseconds(0), ball_images(160)));
  }
  EXPECT_EQ(fast_finder.poll(milliseconds(25)).size(), 1U);
  EXPECT_TRUE(slow_finder.poll(milliseconds(49)).empty());
  EXPECT_TRUE(fast_finder.poll(milliseconds(50)).empty());
  EXPECT_EQ(slow_finder.poll(milliseconds(50)).size(), 1U);
  EXPECT_EQ(executor->statistics().delivered, 2U);
}

TEST(Lockstep, DeliversInOrderOfDueTime) {
  const auto executor = make_lockstep_executor();
  std::vector<int> order;
  for (const int due : {30, 10, 20, 10}) {
    executor->submit({nullptr, milliseconds(due), [](std::stop_token) {},
                      [&order, due, n = executor->statistics().submitted] {
                        order.push_back(due * 10 + static_cast<int>(n));
                      }});
  }
  EXPECT_EQ(executor->poll(milliseconds(25)), 3U);
  EXPECT_EQ(order, (std::vector<int>{101, 103, 202}));
  EXPECT_EQ(executor->poll(milliseconds(30)), 1U);
}

TEST(Realtime, NewestFrameWins) {
  const auto executor = make_realtime_executor();
  BallFinder finder(*executor, {});
  // The first frame's pixels hold the worker up while three more arrive.
  std::promise<std::shared_ptr<const StereoImages>> promise;
  StereoPair first = pair_at(0, milliseconds(0));
  first.images = promise.get_future().share();
  finder.submit(std::move(first));
  std::this_thread::sleep_for(milliseconds(50));
  for (std::uint64_t i = 1; i <= 3; ++i) {
    finder.submit(pair_with(i, milliseconds(33 * i), ball_images(160)));
  }
  promise.set_value(ball_images(160));
  std::vector<std::uint64_t> sequences;
  EXPECT_TRUE(wait_until([&] {
    for (const auto& ball : finder.poll(Time(0))) sequences.push_back(ball.info.sequence);
    return !sequences.empty() && sequences.back() == 3;
  }));
  EXPECT_EQ(sequences, (std::vector<std::uint64_t>{0, 3}));
  EXPECT_EQ(executor->statistics().dropped, 2U);
  EXPECT_EQ(executor->statistics().submitted, 4U);
  EXPECT_EQ(executor->statistics().delivered, 2U);
}

TEST(Realtime, OneModuleDoesNotDropAnothersFrames) {
  const auto executor = make_realtime_executor();
  BallFinder a(*executor, {}), b(*executor, {});
  std::promise<std::shared_ptr<const StereoImages>> promise;
  StereoPair first = pair_at(0, milliseconds(0));
  first.images = promise.get_future().share();
  a.submit(std::move(first));
  a.submit(pair_with(1, milliseconds(33), ball_images(160)));
  b.submit(pair_with(1, milliseconds(33), ball_images(160)));
  promise.set_value(ball_images(160));
  EXPECT_TRUE(wait_until([&] { return !b.poll(Time(0)).empty(); }));
}

class Both : public testing::TestWithParam<std::unique_ptr<Executor> (*)()> {};

TEST_P(Both, AnExceptionBecomesAnError) {
  const auto executor = GetParam()();
  BallFinder finder(*executor, {});
  StereoPair broken = pair_at(5, milliseconds(0));
  {
    std::promise<std::shared_ptr<const StereoImages>> promise;
    broken.images = promise.get_future().share();
  }  // a promise that is never kept
  finder.submit(std::move(broken));
  std::vector<BallObservation> ready;
  EXPECT_TRUE(wait_until([&] { return !(ready = finder.poll(milliseconds(1000))).empty(); }));
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_FALSE(ready[0].found);
  EXPECT_EQ(ready[0].info.sequence, 5U);
  ASSERT_TRUE(ready[0].error.has_value());
  EXPECT_FALSE(ready[0].error->message.empty());
}

TEST_P(Both, PairsWithoutPixelsAreErrors) {
  const auto executor = GetParam()();
  BallFinder finder(*executor, {});
  finder.submit(pair_at(1, milliseconds(0)));  // no future at all
  std::vector<BallObservation> ready;
  EXPECT_TRUE(wait_until([&] { return !(ready = finder.poll(milliseconds(1000))).empty(); }));
  EXPECT_TRUE(ready.at(0).error.has_value());
  finder.submit(pair_with(2, milliseconds(33), nullptr));
  EXPECT_TRUE(wait_until([&] { return !(ready = finder.poll(milliseconds(1000))).empty(); }));
  EXPECT_TRUE(ready.at(0).error.has_value());
}

TEST_P(Both, ShutsDownWhileAFrameIsStillOnItsWay) {
  std::promise<std::shared_ptr<const StereoImages>> never;
  auto executor = GetParam()();
  BallFinder finder(*executor, {});
  StereoPair pair = pair_at(1, milliseconds(0));
  pair.images = never.get_future().share();
  finder.submit(std::move(pair));
  finder.submit(pair_with(2, milliseconds(33), ball_images(160)));
  std::this_thread::sleep_for(milliseconds(10));
  const auto start = std::chrono::steady_clock::now();
  executor.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
}

TEST_P(Both, TheFinderMayGoBeforeItsWork) {
  const auto executor = GetParam()();
  {
    BallFinder finder(*executor, {});
    finder.submit(pair_with(1, milliseconds(0), ball_images(160)));
  }
  EXPECT_TRUE(wait_until([&] {
    executor->poll(milliseconds(1000));
    return executor->statistics().delivered == 1;
  }));
}

TEST_P(Both, NeverRunsTwoWorksOfOneExecutorAtOnce) {
  const auto executor = GetParam()();
  std::atomic<int> running{0}, most{0};
  const int module[40] = {};
  for (const int& m : module) {
    executor->submit({&m, Time(0),
                      [&](std::stop_token) {
                        most = std::max(most.load(), ++running);
                        std::this_thread::sleep_for(std::chrono::microseconds(200));
                        --running;
                      },
                      [] {}});
  }
  EXPECT_TRUE(wait_until([&] {
    executor->poll(Time(0));
    return executor->statistics().delivered == 40;
  }));
  EXPECT_EQ(most, 1);
}

INSTANTIATE_TEST_SUITE_P(Executors, Both,
                         testing::Values(&make_lockstep_executor, &make_realtime_executor));

TEST(RunGuarded, NamesTheModule) {
  EXPECT_TRUE(run_guarded("flow", [] {}));
  const auto failed = run_guarded("flow", [] { throw std::runtime_error("no texture"); });
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().message.find("flow"), std::string::npos);
  EXPECT_NE(failed.error().message.find("no texture"), std::string::npos);
  EXPECT_FALSE(run_guarded("flow", [] { throw 3; }));
}

}  // namespace
}  // namespace kaz::vision
