// Pipelines: delivery times, order, what needs what, dropping, failure, shutdown.
// SPDX-License-Identifier: Apache-2.0
#include "vision/pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <latch>
#include <stdexcept>
#include <thread>

#include "vision/image/pictures_testing.h"
#include "vision/pipeline/brightness_example.h"
#include "vision/pipeline/modules.h"

namespace kaz::vision {
namespace {

using std::chrono::milliseconds;
using Sequences = std::vector<std::uint64_t>;

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

StereoPair grey_pair(std::uint64_t sequence, Time exposure) {
  static const auto images = std::make_shared<const StereoImages>();
  return pair_with(sequence, exposure, images);
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

// A user's module: whatever a test wants it to do.
class TestModule final : public Module {
 public:
  using Look = std::function<Result<std::any>(const Frame&)>;
  TestModule(std::string name, std::vector<std::string> needs, Time latency, Look look)
      : name_(std::move(name)),
        needs_(std::move(needs)),
        latency_(latency),
        look_(std::move(look)) {}
  std::string name() const override { return name_; }
  std::vector<std::string> needs() const override { return needs_; }
  Time latency() const override { return latency_; }
  Result<std::any> look(const Frame& frame) override { return look_(frame); }

 private:
  std::string name_;
  std::vector<std::string> needs_;
  Time latency_;
  Look look_;
};

void add(Pipeline& pipeline, std::string name, std::vector<std::string> needs, Time latency,
         TestModule::Look look) {
  const auto added = pipeline.add(
      std::make_unique<TestModule>(std::move(name), std::move(needs), latency, std::move(look)));
  ASSERT_TRUE(added) << added.error().message;
}

Result<std::any> sequence_of(const Frame& frame) {
  return std::any(frame.info().sequence);
}

// What came of a module whose result is a sequence number.
struct Heard {
  Sequences values;
  std::vector<std::string> errors;
};
void hear(Pipeline& pipeline, const std::string& module, Heard& heard) {
  ASSERT_TRUE(pipeline.subscribe<std::uint64_t>(
      module, [&heard](const Frame& frame, const std::uint64_t* value, const Error* error) {
        if (error != nullptr) return heard.errors.push_back(error->message);
        EXPECT_EQ(*value, frame.info().sequence);
        heard.values.push_back(*value);
      }));
}

// A pipeline with the color module and a subscriber, as a behavior uses them to find the ball.
struct Balls {
  explicit Balls(const PipelineOptions& options, Time latency = milliseconds(5))
      : pipeline(options) {
    EXPECT_TRUE(pipeline.add(make_color_module({}, latency)));
    EXPECT_TRUE(pipeline.subscribe<BallObservation>(
        "color", [this](const Frame& frame, const BallObservation* ball, const Error* error) {
          EXPECT_NE(ball == nullptr, error == nullptr);
          if (ball != nullptr) {
            EXPECT_EQ(ball->info.sequence, frame.info().sequence);
            seen.push_back(*ball);
          } else {
            errors.push_back(error->message);
          }
        }));
  }
  std::vector<BallObservation> poll(Time now) {
    seen.clear();
    pipeline.poll(now);
    return seen;
  }
  std::vector<BallObservation> seen;
  std::vector<std::string> errors;
  Pipeline pipeline;
};

constexpr PipelineOptions kLockstep{Pace::lockstep, milliseconds(20)};
constexpr PipelineOptions kRealtime{Pace::realtime, milliseconds(20)};

TEST(Lockstep, DeliversExactlyWhenDue) {
  Balls balls(kLockstep);
  balls.pipeline.submit(pair_with(1, milliseconds(100), ball_images(160)));
  std::this_thread::sleep_for(milliseconds(30));  // done long before, and yet
  EXPECT_TRUE(balls.poll(milliseconds(100)).empty());
  EXPECT_TRUE(balls.poll(milliseconds(125) - Time(1)).empty());
  const auto ready = balls.poll(milliseconds(125));
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_TRUE(ready[0].found);
  EXPECT_NEAR(ready[0].center_u, 160, 0.1);
  EXPECT_TRUE(balls.poll(milliseconds(1000)).empty());
}

TEST(Lockstep, WaitsForPixelsThatAreLate) {
  Balls balls(kLockstep);
  std::promise<std::shared_ptr<const StereoImages>> promise;
  StereoPair pair = pair_at(7, milliseconds(0));
  pair.images = promise.get_future().share();
  balls.pipeline.submit(std::move(pair));  // does not wait
  EXPECT_TRUE(balls.poll(milliseconds(24)).empty());
  std::jthread renderer([&] {
    std::this_thread::sleep_for(milliseconds(40));
    promise.set_value(ball_images(100));
  });
  const auto ready = balls.poll(milliseconds(25));
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_NEAR(ready[0].center_u, 100, 0.1);
}

TEST(Lockstep, FrameInformationTravelsWithItsResult) {
  Balls balls(kLockstep);
  constexpr std::uint64_t kFrames = 12;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const double u = 60 + 15.0 * static_cast<double>(i);
    balls.pipeline.submit(pair_with(i, milliseconds(33 * i), ball_images(u)));
  }
  const auto ready = balls.poll(milliseconds(10000));
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

TEST(Lockstep, WhatNeedsAnotherIsDueAfterIt) {
  Pipeline pipeline(kLockstep);
  add(pipeline, "a", {}, milliseconds(5), sequence_of);
  add(pipeline, "b", {}, milliseconds(12), sequence_of);
  add(pipeline, "both", {"a", "b"}, milliseconds(3), [](const Frame& frame) {
    return std::any(std::max(frame.of<std::uint64_t>("a"), frame.of<std::uint64_t>("b")));
  });
  std::vector<std::pair<std::string, Time>> log;
  pipeline.log([&](const Delivery& d) {
    EXPECT_FALSE(d.failed);
    EXPECT_GE(d.computing_s, 0);
    log.emplace_back(d.module, d.delivered);
  });
  pipeline.submit(grey_pair(1, milliseconds(100)));
  EXPECT_EQ(pipeline.poll(milliseconds(134)), 2U);
  EXPECT_EQ(pipeline.poll(milliseconds(135)), 1U);
  using Entry = std::pair<std::string, Time>;
  EXPECT_EQ(log,
            (std::vector<Entry>{
                {"a", milliseconds(125)}, {"b", milliseconds(132)}, {"both", milliseconds(135)}}));
  const auto statistics = pipeline.statistics();
  ASSERT_EQ(statistics.size(), 3U);
  EXPECT_EQ(statistics[2].name, "both");
  EXPECT_EQ(statistics[2].delivered, 1U);
  EXPECT_DOUBLE_EQ(statistics[2].age_median_s, 0.035);
}

TEST(Lockstep, DropsNothingHoweverSlowAModuleIs) {
  Pipeline pipeline(kLockstep);
  add(pipeline, "slow", {}, milliseconds(1), [](const Frame& frame) {
    std::this_thread::sleep_for(milliseconds(2));
    return sequence_of(frame);
  });
  Heard heard;
  hear(pipeline, "slow", heard);
  for (std::uint64_t i = 0; i < 20; ++i) pipeline.submit(grey_pair(i, milliseconds(i)));
  EXPECT_EQ(pipeline.poll(milliseconds(1000)), 20U);
  for (std::uint64_t i = 0; i < 20; ++i) EXPECT_EQ(heard.values.at(i), i);
}

TEST(Realtime, NewestFrameWins) {
  Balls balls(kRealtime);
  // The first frame's pixels hold the module up while three more arrive.
  std::promise<std::shared_ptr<const StereoImages>> promise;
  StereoPair first = pair_at(0, milliseconds(0));
  first.images = promise.get_future().share();
  balls.pipeline.submit(std::move(first));
  std::this_thread::sleep_for(milliseconds(50));
  for (std::uint64_t i = 1; i <= 3; ++i)
    balls.pipeline.submit(pair_with(i, milliseconds(33 * i), ball_images(160)));
  promise.set_value(ball_images(160));
  Sequences sequences;
  EXPECT_TRUE(wait_until([&] {
    for (const auto& ball : balls.poll(Time(0))) sequences.push_back(ball.info.sequence);
    return !sequences.empty() && sequences.back() == 3;
  }));
  EXPECT_EQ(sequences, (Sequences{0, 3}));
  EXPECT_EQ(balls.pipeline.statistics()[0].dropped, 2U);
  EXPECT_EQ(balls.pipeline.statistics()[0].delivered, 2U);
}

// A slow module drops frames; what needs it and a fast one sees each frame whole or not at all.
TEST(Realtime, ASlowModuleDelaysNoOtherAndNothingIsMixed) {
  Pipeline pipeline(kRealtime);
  std::latch go(1);
  std::atomic<bool> begun{false};
  add(pipeline, "fast", {}, Time(0), sequence_of);
  add(pipeline, "slow", {}, Time(0), [&](const Frame& frame) {
    begun = true;
    go.wait();
    return sequence_of(frame);
  });
  add(pipeline, "both", {"fast", "slow"}, Time(0), [](const Frame& frame) -> Result<std::any> {
    if (frame.of<std::uint64_t>("fast") != frame.of<std::uint64_t>("slow"))
      return fail(Fault::failed, "mixed");
    return sequence_of(frame);
  });
  Heard fast, slow, both;
  hear(pipeline, "fast", fast);
  hear(pipeline, "slow", slow);
  hear(pipeline, "both", both);
  for (std::uint64_t i = 0; i < 10; ++i) {
    pipeline.submit(grey_pair(i, milliseconds(33 * i)));
    EXPECT_TRUE(wait_until([&] {
      pipeline.poll(milliseconds(33 * i));
      return fast.values.size() == i + 1 && begun;
    }));
  }
  EXPECT_TRUE(slow.values.empty());
  go.count_down();
  EXPECT_TRUE(wait_until([&] {
    pipeline.poll(milliseconds(400));
    return !both.values.empty() && both.values.back() == 9;
  }));
  EXPECT_EQ(slow.values, (Sequences{0, 9}));
  // Frame 0, unless frame 9 overtook it in front of the module.
  EXPECT_TRUE(both.values == (Sequences{0, 9}) || both.values == Sequences{9});
  EXPECT_TRUE(both.errors.empty());
  const auto statistics = pipeline.statistics();
  EXPECT_EQ(statistics[1].dropped, 8U);
  EXPECT_EQ(statistics[2].dropped + both.values.size(), 10U);
}

class Paces : public testing::TestWithParam<Pace> {
 protected:
  PipelineOptions options() const { return {GetParam(), milliseconds(20)}; }
};

TEST_P(Paces, APromiseThatIsNotKeptIsAnError) {
  Balls balls(options());
  StereoPair broken = pair_at(5, milliseconds(0));
  {
    std::promise<std::shared_ptr<const StereoImages>> promise;
    broken.images = promise.get_future().share();
  }
  balls.pipeline.submit(std::move(broken));
  EXPECT_TRUE(wait_until([&] {
    balls.poll(milliseconds(1000));
    return !balls.errors.empty();
  }));
  EXPECT_TRUE(balls.seen.empty());
  EXPECT_NE(balls.errors.at(0).find("camera"), std::string::npos);
}

TEST_P(Paces, PairsWithoutPixelsAreErrors) {
  Balls balls(options());
  balls.pipeline.submit(pair_at(1, milliseconds(0)));  // no future at all
  EXPECT_TRUE(wait_until([&] {
    balls.poll(milliseconds(1000));
    return balls.errors.size() == 1;
  }));
  balls.pipeline.submit(pair_with(2, milliseconds(33), nullptr));
  EXPECT_TRUE(wait_until([&] {
    balls.poll(milliseconds(1000));
    return balls.errors.size() == 2;
  }));
  EXPECT_EQ(balls.pipeline.statistics()[0].failed, 2U);
}

TEST_P(Paces, WhatFailsFailsForThoseThatNeedIt) {
  Pipeline pipeline(options());
  add(pipeline, "throws", {}, Time(0), [](const Frame& frame) -> Result<std::any> {
    if (frame.info().sequence == 1) throw std::runtime_error("no texture");
    return sequence_of(frame);
  });
  add(pipeline, "next", {"throws"}, Time(0), sequence_of);
  add(pipeline, "careless", {}, Time(0),
      [](const Frame& frame) { return std::any(frame.of<double>("nobody")); });
  Heard next, careless;
  hear(pipeline, "next", next);
  hear(pipeline, "careless", careless);
  for (std::uint64_t i = 0; i < 2; ++i) {
    pipeline.submit(grey_pair(i, milliseconds(33 * i)));
    EXPECT_TRUE(wait_until([&] {
      pipeline.poll(milliseconds(1000));
      return next.values.size() + next.errors.size() == i + 1 && careless.errors.size() == i + 1;
    }));
  }
  EXPECT_EQ(next.values, (Sequences{0}));
  ASSERT_EQ(next.errors.size(), 1U);
  EXPECT_NE(next.errors[0].find("throws"), std::string::npos);
  EXPECT_NE(next.errors[0].find("no texture"), std::string::npos);
  EXPECT_NE(careless.errors[0].find("nobody"), std::string::npos);
}

TEST_P(Paces, GapsAreMarked) {
  Pipeline pipeline(options());
  std::vector<bool> gaps;
  add(pipeline, "gap", {}, Time(0), [&](const Frame& frame) {
    gaps.push_back(frame.after_gap());
    return sequence_of(frame);
  });
  Heard heard;
  hear(pipeline, "gap", heard);
  // First, next, one left out, clock stepped back, next.
  const std::pair<std::uint64_t, int> frames[] = {{4, 100}, {5, 133}, {7, 200}, {8, 50}, {9, 83}};
  for (const auto& [sequence, ms] : frames) {
    pipeline.submit(grey_pair(sequence, milliseconds(ms)));
    EXPECT_TRUE(wait_until([&] {
      pipeline.poll(milliseconds(1000));
      return !heard.values.empty() && heard.values.back() == sequence;
    }));
  }
  EXPECT_EQ(gaps, (std::vector<bool>{true, false, true, true, false}));
}

TEST_P(Paces, FinishDeliversAllThatIsUnderWay) {
  Pipeline pipeline(options());
  add(pipeline, "slow", {}, milliseconds(30), [](const Frame& frame) {
    std::this_thread::sleep_for(milliseconds(20));
    return sequence_of(frame);
  });
  add(pipeline, "next", {"slow"}, milliseconds(30), sequence_of);
  Heard next;
  hear(pipeline, "next", next);
  pipeline.submit(grey_pair(1, milliseconds(0)));
  EXPECT_EQ(pipeline.finish(), 2U);
  EXPECT_EQ(next.values, (Sequences{1}));
  EXPECT_EQ(pipeline.finish(), 0U);
}

TEST_P(Paces, ShutsDownWhileAFrameIsStillOnItsWay) {
  std::promise<std::shared_ptr<const StereoImages>> never;
  auto pipeline = std::make_unique<Pipeline>(options());
  ASSERT_TRUE(pipeline->add(make_color_module({})));
  ASSERT_TRUE(pipeline->add(make_depth_module({})));
  ASSERT_TRUE(pipeline->add(make_planes_module({})));
  StereoPair pair = pair_at(1, milliseconds(0));
  pair.images = never.get_future().share();
  pipeline->submit(std::move(pair));
  pipeline->submit(pair_with(2, milliseconds(33), ball_images(160)));
  std::this_thread::sleep_for(milliseconds(10));
  const auto start = std::chrono::steady_clock::now();
  pipeline.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
}

INSTANTIATE_TEST_SUITE_P(Pipeline, Paces, testing::Values(Pace::lockstep, Pace::realtime),
                         [](const auto& pace) {
                           return pace.param == Pace::lockstep ? "lockstep" : "realtime";
                         });

TEST(Pipeline, FlowBeginsAnewAfterAGap) {
  Pipeline pipeline(kLockstep);
  ASSERT_TRUE(pipeline.add(make_flow_module({})));
  std::vector<int> widths;
  ASSERT_TRUE(pipeline.subscribe<FlowImage>(
      "flow", [&](const Frame& frame, const FlowImage* flow, const Error* error) {
        ASSERT_NE(flow, nullptr) << error->message;
        EXPECT_EQ(flow->after.sequence, frame.info().sequence);
        if (flow->width > 0) {
          EXPECT_LT(flow->before.sequence, frame.info().sequence);
        }
        widths.push_back(flow->width);
      }));
  // First, next, clock stepped back, next, one left out, a second of nothing.
  const std::pair<std::uint64_t, int> frames[] = {{1, 100}, {2, 133}, {3, 50},
                                                  {4, 83},  {6, 150}, {7, 1150}};
  for (const auto& [sequence, ms] : frames) {
    pipeline.submit(pair_with(sequence, milliseconds(ms), ball_images(160)));
    pipeline.poll(milliseconds(2000));
  }
  EXPECT_EQ(widths, (std::vector<int>{0, 320, 0, 320, 320, 0}));
}

TEST(Pipeline, WhatMovesIsSaidOfFramesWithFlow) {
  Pipeline pipeline(kLockstep);
  ASSERT_TRUE(pipeline.add(make_flow_module({})));
  ASSERT_TRUE(pipeline.add(make_depth_module({})));
  ASSERT_TRUE(pipeline.add(make_independent_motion_module({})));
  std::vector<bool> said;
  std::vector<std::string> errors;
  ASSERT_TRUE(pipeline.subscribe<MovingRegions>(
      "moving", [&](const Frame&, const MovingRegions* moving, const Error* error) {
        if (error != nullptr) return errors.push_back(error->message);
        said.push_back(moving->cells_across > 0);
      }));
  for (std::uint64_t i = 0; i < 4; ++i) {
    StereoPair pair = pair_with(i, milliseconds(33 * i), ball_images(160));
    pair.info.posture_known = i != 3;
    pipeline.submit(std::move(pair));
  }
  pipeline.poll(milliseconds(2000));
  EXPECT_EQ(said, (std::vector<bool>{false, true, true}));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_NE(errors[0].find("posture"), std::string::npos) << errors[0];
}

TEST(Pipeline, TakesAUsersModule) {
  Pipeline pipeline(kLockstep);
  ASSERT_TRUE(pipeline.add(make_brightness_module()));
  std::vector<Brightness> seen;
  std::vector<std::string> errors;
  ASSERT_TRUE(pipeline.subscribe<Brightness>(
      "brightness", [&](const Frame&, const Brightness* brightness, const Error* error) {
        if (brightness != nullptr) seen.push_back(*brightness);
        if (error != nullptr) errors.push_back(error->message);
      }));
  auto images = std::make_shared<StereoImages>();
  images->left = {2, 1, {10, 20, 30, 40, 50, 60}};
  images->right = {1, 1, {7, 7, 7}};
  pipeline.submit(pair_with(1, Time(0), images));
  pipeline.submit(grey_pair(2, milliseconds(33)));
  EXPECT_EQ(pipeline.poll(milliseconds(1000)), 2U);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_DOUBLE_EQ(seen[0].left, 35);
  EXPECT_DOUBLE_EQ(seen[0].right, 7);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_NE(errors[0].find("empty"), std::string::npos);
}

TEST(Pipeline, RefusesWhatDoesNotFit) {
  Pipeline pipeline(kLockstep);
  const auto early = pipeline.add(make_planes_module({}));
  ASSERT_FALSE(early);
  EXPECT_NE(early.error().message.find("needs 'depth'"), std::string::npos);
  EXPECT_TRUE(pipeline.add(make_depth_module({})));
  EXPECT_FALSE(pipeline.add(make_depth_module({})));
  EXPECT_TRUE(pipeline.add(make_planes_module({})));
  EXPECT_TRUE(pipeline.has("planes"));
  EXPECT_FALSE(
      pipeline.subscribe<DepthImage>("dept", [](const Frame&, const DepthImage*, const Error*) {}));
  std::string wrong;
  ASSERT_TRUE(pipeline.subscribe<int>(
      "depth", [&](const Frame&, const int*, const Error* error) { wrong = error->message; }));
  pipeline.submit(pair_with(1, Time(0), ball_images(100)));
  EXPECT_FALSE(pipeline.add(make_color_module({})));
  pipeline.poll(milliseconds(1000));
  EXPECT_NE(wrong.find("another type"), std::string::npos);
}

}  // namespace
}  // namespace kaz::vision
