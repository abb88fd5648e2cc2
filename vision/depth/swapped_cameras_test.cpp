// Swapped eyes: of one pair, and of a whole run.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/swapped_cameras.h"

#include <gtest/gtest.h>

#include "vision/depth/stereo_testing.h"

namespace kaz::vision {
namespace {

struct Pairs {
  explicit Pairs(int width = 320)
      : camera(test_camera(width, width * 3 / 4)), right(test_room().pictures(camera, 2, 5)) {
    swapped = {right.right, right.left};
    std::vector<std::uint8_t> grey(right.left.rgb.size(), 128);
    dark.left = dark.right = {right.left.width, right.left.height, grey};
  }
  CameraModel camera;
  StereoImages right, swapped, dark;
};

TEST(EyeOrder, IsSeenInAPair) {
  for (const int width : {320, 640}) {
    const Pairs pairs(width);
    const FrameInfo info = test_info(pairs.camera);
    EXPECT_EQ(eye_order(pairs.right, info), EyeOrder::as_named);
    EXPECT_EQ(eye_order(pairs.swapped, info), EyeOrder::swapped);
    EXPECT_EQ(eye_order(pairs.dark, info), EyeOrder::unclear);
    EXPECT_EQ(eye_order({pairs.right.left, {}}, info), EyeOrder::unclear);
  }
}

// A letter a pair, ten a second: r right, s swapped, d dark.
bool found(const std::string& run) {
  static const Pairs pairs;
  SwappedCameras judge;
  FrameInfo info = test_info(pairs.camera);
  info.exposure = Time(0);
  for (const char pair : run) {
    judge.look(pair == 'r' ? pairs.right : pair == 's' ? pairs.swapped : pairs.dark, info);
    info.exposure += std::chrono::milliseconds(100);
  }
  return judge.found();
}

TEST(SwappedCameras, AreFoundInAWholeRun) {
  EXPECT_TRUE(found("s"));
  EXPECT_TRUE(found("sss"));
  EXPECT_TRUE(found(std::string(60, 's')));
  EXPECT_TRUE(found("ddsss"));
  // Dark, or disturbed, for a while.
  EXPECT_TRUE(found(std::string(20, 'd') + std::string(40, 's')));
  EXPECT_TRUE(found("r" + std::string(40, 's')));
}

TEST(SwappedCameras, AreNotFoundInAFewPairs) {
  EXPECT_FALSE(found(""));
  EXPECT_FALSE(found(std::string(60, 'r')));
  EXPECT_FALSE(found("srr"));
  EXPECT_FALSE(found("sr"));
  EXPECT_FALSE(found("s" + std::string(60, 'r')));
  EXPECT_FALSE(found("sssss" + std::string(60, 'r')));
  EXPECT_FALSE(found(std::string(40, 'r') + std::string(10, 's')));
  EXPECT_FALSE(found("s" + std::string(60, 'd')));
  EXPECT_FALSE(found("dd"));
}

}  // namespace
}  // namespace kaz::vision
