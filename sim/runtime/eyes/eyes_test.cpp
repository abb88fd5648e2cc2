// When pictures are taken, drawn and delivered.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/eyes/eyes.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <fstream>
#include <mutex>

#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

using std::chrono::milliseconds;

// Draws nothing until the gate is open.
class Gate {
 public:
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void pass() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return open_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
};

class GatedRenderer final : public Renderer {
 public:
  explicit GatedRenderer(Gate& gate) : gate_(gate) {}
  Result<void> set_scene(const Scene&) override { return {}; }
  Result<void> render(const ScenePose& pose, const View& view, vision::Image& picture) override {
    gate_.pass();
    return TestRenderer().render(pose, view, picture);
  }

 private:
  Gate& gate_;
};

// Records the key light of each request.
class LightRenderer final : public Renderer {
 public:
  explicit LightRenderer(std::vector<double>& keys) : keys_(keys) {}
  Result<void> set_scene(const Scene&) override { return {}; }
  Result<void> render(const ScenePose& pose, const View& view, vision::Image& picture) override {
    keys_.push_back(view.light.key);
    return TestRenderer().render(pose, view, picture);
  }

 private:
  std::vector<double>& keys_;
};

RendererFactory gated(Gate& gate) {
  return [&gate]() -> Result<std::unique_ptr<Renderer>> {
    return std::unique_ptr<Renderer>(std::make_unique<GatedRenderer>(gate));
  };
}

ScenePose still() {
  return {{Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()}};
}

Eyes::Mounting mounting() {
  Eyes::Mounting m;
  m.head_frame = 1;
  m.left.translation() = Eigen::Vector3d(0.03, 0.02, 0);
  m.right.translation() = Eigen::Vector3d(0.03, -0.02, 0);
  return m;
}

TEST(Eyes, SeeByTheLightOfTheirWorld) {
  for (const bool ideal : {true, false}) {
    std::vector<double> keys;
    {
      RenderThread draws({}, [&]() -> Result<std::unique_ptr<Renderer>> {
        return std::unique_ptr<Renderer>(std::make_unique<LightRenderer>(keys));
      });
      CameraFile camera = small_camera();
      camera.ideal = ideal;
      Eyes::Mounting dim = mounting();
      dim.light.key = 0.25;
      Eyes eyes(draws, camera, dim, FramePolicy::wait, Eyes::Keep::digests);
      for (int t = 1; t <= 34; ++t) ASSERT_TRUE(eyes.look(milliseconds(t), still));
      eyes.take_digests(true);  // waits for the drawing
    }
    ASSERT_GE(keys.size(), 2u);
    for (const double key : keys) EXPECT_EQ(key, 0.25);
  }
}

TEST(Eyes, ExposeThirtyTimesASecondOnTheStepGrid) {
  RenderThread draws({}, make_test_renderer);
  Eyes eyes(draws, small_camera(), mounting(), FramePolicy::wait, Eyes::Keep::nothing);
  std::vector<std::int64_t> exposures;
  std::vector<std::uint64_t> sequences;
  for (int t = 1; t <= 200; ++t) {
    ASSERT_TRUE(eyes.look(milliseconds(t), still));
    while (const auto pair = eyes.next_pair(milliseconds(t))) {
      exposures.push_back(pair->info.exposure.count() / 1'000'000);
      sequences.push_back(pair->info.sequence);
    }
  }
  // n / 30 s, rounded to the millisecond: 33.3, 66.7, 100, 133.3, 166.7, (200 is still under way)
  EXPECT_EQ(exposures, (std::vector<std::int64_t>{33, 67, 100, 133, 167}));
  EXPECT_EQ(sequences, (std::vector<std::uint64_t>{1, 2, 3, 4, 5}));
}

TEST(Eyes, DeliverAfterTheDeclaredLatency) {
  RenderThread draws({}, make_test_renderer);
  Eyes eyes(draws, small_camera(), mounting(), FramePolicy::wait, Eyes::Keep::nothing);
  ASSERT_TRUE(eyes.look(milliseconds(33), still));
  EXPECT_FALSE(eyes.next_pair(milliseconds(47)));
  const auto pair = eyes.next_pair(milliseconds(48));  // 33 + 15 ms
  ASSERT_TRUE(pair);
  const auto images = pair->images.get();
  EXPECT_EQ(images->left.width, 32);
  EXPECT_EQ(images->left.rgb.size(), 32u * 24 * 3);
  EXPECT_EQ(images->left.rgb[0], 30);
  EXPECT_EQ(images->left.rgb[1], 20);
  EXPECT_EQ(images->right.rgb[1], 256 - 20);
  EXPECT_FALSE(pair->info.posture_known);
}

TEST(Eyes, DropWhatCannotBeDrawnInTime) {
  Gate gate;
  RenderThread draws({}, gated(gate));
  Eyes eyes(draws, small_camera(), mounting(), FramePolicy::drop, Eyes::Keep::nothing);
  for (int t = 1; t <= 1000; ++t) ASSERT_TRUE(eyes.look(milliseconds(t), still));
  EXPECT_EQ(eyes.left_out(), 30u - 3);  // three are under way
  gate.open();
  std::vector<std::uint64_t> sequences;
  while (const auto pair = eyes.next_pair(std::chrono::seconds(2))) {
    pair->images.wait();
    sequences.push_back(pair->info.sequence);
  }
  EXPECT_EQ(sequences, (std::vector<std::uint64_t>{1, 2, 3}));
}

TEST(Eyes, KeepAtMostEightForAHostThatDoesNotTakeThem) {
  RenderThread draws({}, make_test_renderer);
  Eyes eyes(draws, small_camera(), mounting(), FramePolicy::wait, Eyes::Keep::nothing);
  for (int t = 1; t <= 1000; ++t) ASSERT_TRUE(eyes.look(milliseconds(t), still));
  int kept = 0;
  std::uint64_t first = 0;
  while (const auto pair = eyes.next_pair(std::chrono::seconds(2))) {
    if (kept++ == 0) first = pair->info.sequence;
  }
  EXPECT_EQ(kept, 8);
  EXPECT_EQ(first, 23u);  // the newest of 1..30
}

TEST(Eyes, SkipExposuresWhileNobodyLooks) {
  RenderThread draws({}, make_test_renderer);
  Eyes eyes(draws, small_camera(), mounting(), FramePolicy::wait, Eyes::Keep::nothing);
  ASSERT_TRUE(eyes.look(milliseconds(1000), still));
  ASSERT_TRUE(eyes.look(milliseconds(1010), still));
  const auto pair = eyes.next_pair(std::chrono::seconds(2));
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->info.sequence, 30u);
  EXPECT_FALSE(eyes.next_pair(std::chrono::seconds(2)));
}

TEST(Eyes, ReportWhyThereAreNoPictures) {
  RenderThread draws({}, []() -> Result<std::unique_ptr<Renderer>> {
    return fail(Fault::environment, "no OpenGL here");
  });
  Eyes eyes(draws, small_camera(), mounting(), FramePolicy::wait, Eyes::Keep::nothing);
  ASSERT_TRUE(eyes.look(milliseconds(33), still));
  const auto pair = eyes.next_pair(milliseconds(48));
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->images.get()->left.rgb, std::vector<std::uint8_t>(32 * 24 * 3, 0));
  const auto looked = eyes.look(milliseconds(34), still);
  ASSERT_FALSE(looked);
  EXPECT_EQ(looked.error().message, "no OpenGL here");
}

TEST(Eyes, DigestsComeTwoExposuresLater) {
  RenderThread draws({}, make_test_renderer);
  Eyes eyes(draws, small_camera(), mounting(), FramePolicy::wait, Eyes::Keep::digests);
  ASSERT_TRUE(eyes.look(milliseconds(33), still));
  ASSERT_TRUE(eyes.look(milliseconds(67), still));
  EXPECT_TRUE(eyes.take_digests(false).empty());
  ASSERT_TRUE(eyes.look(milliseconds(100), still));
  const auto digests = eyes.take_digests(false);
  ASSERT_EQ(digests.size(), 1u);
  EXPECT_EQ(digests[0].sequence, 1u);
  EXPECT_EQ(digests[0].kept.left.size(), 32u);
  EXPECT_NE(digests[0].kept.left, digests[0].kept.right);
  EXPECT_EQ(eyes.take_digests(true).size(), 2u);
}

TEST(Eyes, ArriveLaterByUpToTheJitterAndInOrder) {
  CameraFile camera = small_camera();
  camera.jitter_s = 0.004;
  const auto arrivals = [&](std::uint64_t seed) {
    RenderThread draws({}, make_test_renderer);
    Eyes eyes(draws, camera, mounting(), FramePolicy::wait, Eyes::Keep::nothing, seed);
    std::vector<std::int64_t> late_us;  // in steps of 0.1 ms, after the latency of 15 ms
    for (int t = 1; t <= 1000; ++t) {
      EXPECT_TRUE(eyes.look(milliseconds(t), still));
      for (int part = 0; part < 10; ++part) {
        const Time now = milliseconds(t) + std::chrono::microseconds(100 * part);
        while (const auto pair = eyes.next_pair(now))
          late_us.push_back((now - pair->info.exposure).count() / 1000 - 15'000);
      }
    }
    return late_us;
  };
  const auto one = arrivals(1);
  ASSERT_EQ(one.size(), 29u);
  double sum = 0;
  for (const auto late : one) {
    EXPECT_GE(late, 0);
    EXPECT_LE(late, 4100);
    sum += static_cast<double>(late);
  }
  EXPECT_NEAR(sum / 29, 2000, 700);  // three sigma of the mean of 29 even deviates are 640
  EXPECT_EQ(arrivals(1), one);
  EXPECT_NE(arrivals(2), one);
}

TEST(Eyes, RealOnesGiveRectifiedPicturesWithNoiseOfTheSeed) {
  CameraFile camera = small_camera();
  camera.ideal = false;
  const auto picture = [&](std::uint64_t seed, int exposure) {
    RenderThread draws({}, make_test_renderer);
    Eyes eyes(draws, camera, mounting(), FramePolicy::wait, Eyes::Keep::nothing, seed);
    EXPECT_TRUE(eyes.look(milliseconds(exposure == 1 ? 33 : 67), still));
    return eyes.next_pair(milliseconds(500))->images.get();
  };
  const auto first = picture(1, 1);
  EXPECT_EQ(first->left.width, 32);
  EXPECT_EQ(first->left.height, 24);
  EXPECT_EQ(first->left.rgb, picture(1, 1)->left.rgb);
  EXPECT_NE(first->left.rgb, first->right.rgb);
  EXPECT_NE(first->left.rgb, picture(2, 1)->left.rgb);
  EXPECT_NE(first->left.rgb, picture(1, 2)->left.rgb);
}

TEST(CameraFile, OfTheRobotHasBothKindsOfEyes) {
  auto camera = CameraFile::load("shared/robot/kaz/camera.json");
  ASSERT_TRUE(camera) << camera.error().message;
  const vision::StereoCalibration ideal = camera->calibration();
  EXPECT_EQ(ideal.left.lens.distortion, (std::array<double, 5>{}));
  EXPECT_EQ(ideal.left.lens.fx, ideal.rectified.fx);
  camera->ideal = false;
  const vision::StereoCalibration real = camera->calibration();
  EXPECT_LT(real.left.lens.distortion[0], -0.1);
  EXPECT_NE(real.left.lens.fx, real.right.lens.fx);
  EXPECT_EQ(real.rectified.fx, ideal.rectified.fx);
}

TEST(CameraFile, IsReadAndChecked) {
  const TestFolder folder;
  const std::string path = folder.file("camera.json");
  const auto write = [&path](const std::string& width) {
    std::ofstream(path)
        << R"({"width": )" << width
        << R"(, "height": 240, "horizontal_view_deg": 90, "rate_hz": 30, "latency_s": 0.015})";
  };
  write("320");
  const auto camera = CameraFile::load(path);
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->eye.height, 240);
  EXPECT_NEAR(camera->model().fx, 160.0, 1.0);  // half the width at 45 degrees, near enough
  EXPECT_TRUE(camera->ideal);
  EXPECT_EQ(camera->jitter_s, 0);  // what a file may leave out

  write(R"(320, "k1": -0.9)");  // 0.5 - 0.9 * 0.5^3 * 3 < 0: falls before the edge
  const auto folded = CameraFile::load(path);
  ASSERT_FALSE(folded);
  EXPECT_NE(folded.error().message.find("radius does not increase"), std::string::npos);

  write("99999");
  const auto wrong = CameraFile::load(path);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().fault, Fault::usage);
  EXPECT_NE(wrong.error().message.find("\"width\""), std::string::npos);
  EXPECT_FALSE(CameraFile::load(folder.file("none.json")));

  const std::pair<std::string, std::string> invalid[] = {
      {"1e999", ": line 1: the number 1e999 is too large"},
      {R"(320, "width": 640)", ": the key \"width\" occurs twice"}};
  for (const auto& [width, reason] : invalid) {
    write(width);
    const auto read = CameraFile::load(path);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().fault, Fault::usage);
    EXPECT_TRUE(read.error().message.starts_with(path + reason)) << read.error().message;
  }
}

}  // namespace
}  // namespace kaz::sim
