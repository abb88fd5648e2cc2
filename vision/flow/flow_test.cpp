// Flow of pictures shifted by a known displacement, and errors of invalid pairs.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/flow.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <opencv2/core/utility.hpp>

#include "vision/depth/stereo_testing.h"
#include "vision/image/opencv_threads.h"

namespace kaz::vision {
namespace {

using namespace std::chrono_literals;

// A wall straight ahead at `distance`, seen from `x` m to the right: all flows by fx x / distance.
Image wall(const CameraModel& camera, double x, std::uint64_t seed, double contrast = 60) {
  TestStereoScene scene;
  scene.add({-x, 0, 0.5}, {3, 0, 0}, {0, 3, 0}, contrast);
  return scene.pictures(camera, 1, seed).left;
}

FrameInfo at(const CameraModel& camera, Time exposure) {
  FrameInfo info = test_info(camera);
  info.exposure = exposure;
  return info;
}

struct Flow : ::testing::Test {
  CameraModel camera = test_camera(320, 240);
  Image before = wall(camera, 0, 1), after = wall(camera, 0.01, 2);
  FrameInfo first = at(camera, 100ms), second = at(camera, 133ms);
  FlowFinder finder;
  FlowImage flow;

  std::string complaint() {
    const auto found = finder.find(before, first, after, second, flow);
    return found ? "none" : found.error().message;
  }
};

TEST_F(Flow, OfAShiftIsTheShift) {
  ASSERT_TRUE(finder.find(before, first, after, second, flow));
  const double shift = -camera.fx * 0.01 / 0.5;
  int known = 0, good = 0;
  for (const Eigen::Vector2f& f : flow.flow_px) {
    if (std::isnan(f.x())) continue;
    ++known;
    good += (f.cast<double>() - Eigen::Vector2d(shift, 0)).norm() < 0.5;
  }
  EXPECT_GT(known, 320 * 240 / 2);
  EXPECT_GT(good, 0.98 * known);
  EXPECT_NEAR(flow.seconds_between(), 0.033, 1e-9);
  // What the shift takes out of the picture has no flow: a third of its pixels at least are marked
  // by the tests of whole patches.
  int beyond = 0;
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 2; ++u) beyond += flow.known(u, v);
  EXPECT_EQ(beyond, 0);
}

TEST_F(Flow, IsTheSameForGreyAndColouredPicturesAndAgain) {
  ASSERT_TRUE(finder.find(before, first, after, second, flow));
  std::vector<std::uint8_t> a, b;
  for (std::size_t i = 0; i < before.rgb.size(); i += 3) {
    a.push_back(before.rgb[i]);  // grey as RGB
    b.push_back(after.rgb[i]);
  }
  FlowImage again;
  ASSERT_TRUE(
      FlowFinder().find(GreyPicture{320, 240, a}, first, GreyPicture{320, 240, b}, second, again));
  ASSERT_EQ(flow.flow_px.size(), again.flow_px.size());
  for (std::size_t i = 0; i < again.flow_px.size(); ++i) {
    const auto &x = flow.flow_px[i], &y = again.flow_px[i];
    ASSERT_TRUE(x == y || (std::isnan(x.x()) && std::isnan(y.x()))) << i;
  }
}

TEST_F(Flow, IsUnknownWhereThereIsNothingToSee) {
  before = after = plain_picture(320, 240, kTestGrey);
  ASSERT_TRUE(finder.find(before, first, after, second, flow));
  for (const auto& f : flow.flow_px) ASSERT_TRUE(std::isnan(f.x()));
}

// Noise alone has texture, but nothing of it is found again.
TEST_F(Flow, IsUnknownWhereTheNextPictureIsAnother) {
  after = wall(camera, 2.0, 5);
  before = wall(camera, -2.0, 6);
  ASSERT_TRUE(finder.find(before, first, after, second, flow));
  const auto known = std::count_if(flow.flow_px.begin(), flow.flow_px.end(),
                                   [](const auto& f) { return !std::isnan(f.x()); });
  EXPECT_LT(known, 320 * 240 / 20);
}

TEST_F(Flow, SaysWhatIsWrongWithThePictures) {
  after.rgb.pop_back();
  EXPECT_NE(complaint().find("later picture has 230399 bytes"), std::string::npos);
  after = {};
  EXPECT_NE(complaint().find("later picture is empty"), std::string::npos);
  after = plain_picture(20, 20, kTestGrey);
  EXPECT_NE(complaint().find("fewer than 64 per side"), std::string::npos);
  after = plain_picture(640, 480, kTestGrey);
  EXPECT_NE(complaint().find("its camera model has 320 x 240"), std::string::npos);
  second.camera = test_camera(640, 480);
  EXPECT_NE(complaint().find("must come from one eye"), std::string::npos);
  after = wall(camera, 0.01, 2);
  second.camera = camera;
  second.camera.fx += 1;
  EXPECT_NE(complaint().find("camera models of the two pictures differ"), std::string::npos);
  second.camera.fx = 0;
  EXPECT_NE(complaint().find("no focal length"), std::string::npos);
}

TEST_F(Flow, SaysWhenTheClockJumpedBack) {
  second.exposure = 50ms;
  EXPECT_NE(complaint().find("0.050000 s after the second picture"), std::string::npos);
  second.exposure = first.exposure;
  EXPECT_NE(complaint().find("clock jumped back"), std::string::npos);
  second.exposure = 133ms;  // and goes on
  EXPECT_EQ(complaint(), "none");
}

TEST_F(Flow, TakesPicturesOfOddShapes) {
  for (const auto& [width, height] : {std::pair{64, 64}, {65, 67}, {1000, 64}, {64, 900}}) {
    const CameraModel odd = test_camera(width, height);
    const Image picture = wall(odd, 0, 3);
    const auto found = finder.find(picture, at(odd, 1ms), picture, at(odd, 2ms), flow);
    ASSERT_TRUE(found) << found.error().message;
    for (const auto& f : flow.flow_px) ASSERT_FALSE(f.norm() > 0.1) << width << " x " << height;
  }
}

TEST_F(Flow, RefusesOptionsOutOfRange) {
  FlowOptions options;
  options.max_step_px = 0;
  EXPECT_FALSE(FlowFinder(options).find(before, first, after, second, flow));
}

// The search begins anew in each stripe of the picture, of which there are as many as threads.
TEST(OpenCvThreads, AreNotUsedWhereTheFlowShallBeThatOfOneThread) {
  cv::setNumThreads(4);
  keep_opencv_on_callers_threads();
  EXPECT_EQ(cv::getNumThreads(), 1);
}

}  // namespace
}  // namespace kaz::vision
