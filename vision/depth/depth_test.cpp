// Depth against the rays that the pictures were made of, and pictures that have none.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "vision/depth/stereo_testing.h"

namespace kaz::vision {
namespace {

struct Score {
  int textured = 0, good = 0, known = 0;
  std::vector<double> errors;
  double share() const { return static_cast<double>(good) / textured; }
  double percentile(double p) {
    std::sort(errors.begin(), errors.end());
    return errors.empty() ? 0 : errors[static_cast<std::size_t>(p * (errors.size() - 1.0))];
  }
};

// Over pixels that both eyes see, with a whole block of textured surface around them in both
// pictures. A pixel without depth counts as wrong.
Score score(const TestStereoScene& scene, const CameraModel& camera, const DepthImage& depth) {
  std::vector<int> patch;
  const DepthImage truth = scene.truth(camera, patch);
  Score s;
  for (int v = 8; v < camera.height - 8; ++v) {
    for (int u = 8; u < camera.width - 8; ++u) {
      const double d = truth.disparity(u, v);
      if (d <= 0 || u - d < 8 || !scene.seen_by_both(camera, u, v)) continue;
      ++s.textured;
      if (!depth.known(u, v)) continue;
      ++s.known;
      s.errors.push_back(std::abs(depth.disparity(u, v) - d));
      if (s.errors.back() < 0.6) ++s.good;
    }
  }
  return s;
}

TEST(Depth, IsWithinSixTenthsOfAPixelOnTexturedSurfaces) {
  for (const int width : {320, 640}) {
    const CameraModel camera = test_camera(width, width * 3 / 4);
    for (const double sigma : {0.0, 2.0, 4.0}) {
      if (width == 640 && sigma != 2.0) continue;  // the seconds that a test may take
      const TestStereoScene scene = test_room();
      DepthFinder finder;
      DepthImage depth;
      const auto found = finder.find(scene.pictures(camera, sigma, 5), test_info(camera), depth);
      ASSERT_TRUE(found) << found.error().message;
      Score s = score(scene, camera, depth);
      std::printf(
          "%d px, noise %.0f codes: %.1f %% of %d within 0.6 px, %.1f %% known; error 50 %% "
          "%.2f, 90 %% %.2f, 99 %% %.2f px\n",
          width, sigma, 100 * s.share(), s.textured, 100.0 * s.known / s.textured,
          s.percentile(0.5), s.percentile(0.9), s.percentile(0.99));
      EXPECT_GT(s.textured, camera.width * camera.height / 2);
      EXPECT_GE(s.share(), 0.9);
    }
  }
}

TEST(Depth, IsTheSameTwiceAndFromGreyPictures) {
  const CameraModel camera = test_camera();
  const StereoImages pair = test_room().pictures(camera, 2, 9);
  DepthFinder finder, other;
  DepthImage first, second, grey;
  ASSERT_TRUE(finder.find(pair, test_info(camera), first));
  ASSERT_TRUE(finder.find(pair, test_info(camera), second));
  std::vector<std::uint8_t> left, right;  // the pictures' three colours are equal
  for (std::size_t i = 0; i < pair.left.rgb.size(); i += 3) {
    left.push_back(pair.left.rgb[i]);
    right.push_back(pair.right.rgb[i]);
  }
  ASSERT_TRUE(other.find(GreyPicture{320, 240, left}, GreyPicture{320, 240, right},
                         test_info(camera), grey));
  EXPECT_EQ(first.disparity_px, second.disparity_px);
  EXPECT_EQ(first.disparity_px, grey.disparity_px);
}

TEST(Depth, IsTheSameWithoutVectors) {
  const TestStereoScene scene = test_room();
  for (const double nearest : {0.14, 0.3, 0.05, 0.2, 0.6}) {  // 64, 32, 160, 48 and 16 disparities
    for (const int width : {320, 323}) {
      const CameraModel camera = test_camera(width, 240);
      const StereoImages pair = scene.pictures(camera, 2, 5);
      DepthFinder fast({.nearest_m = nearest}), plain({.nearest_m = nearest, .vectors = false});
      DepthImage with, without;
      ASSERT_TRUE(fast.find(pair, test_info(camera), with));
      ASSERT_TRUE(plain.find(pair, test_info(camera), without));
      EXPECT_EQ(with.disparity_px, without.disparity_px);
    }
  }
}

// Half the floor's blocks hold an edge at one side only. What they find must not be that edge's
// disparity, which is 0.1 px a row more or less.
TEST(Depth, OfAFloorIsThatOfTheBlocksMiddle) {
  const CameraModel camera = test_camera();
  const TestStereoScene scene = test_room();
  const StereoImages pair = scene.pictures(camera, 2, 5);
  std::vector<int> patch;
  const DepthImage truth = scene.truth(camera, patch);
  double rms[2];
  for (const int slants : {0, 2}) {
    DepthFinder finder({.slants = slants});
    DepthImage depth;
    ASSERT_TRUE(finder.find(pair, test_info(camera), depth));
    double sum = 0;
    int n = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const double error = static_cast<double>(depth.disparity_px[i] - truth.disparity_px[i]);
      if (patch[i] != 0 || depth.disparity_px[i] == 0 || std::abs(error) > 2) continue;
      sum += error * error;
      ++n;
    }
    ASSERT_GT(n, 10000);
    rms[slants / 2] = std::sqrt(sum / n);
  }
  std::printf("floor: rms %.3f px with blocks facing the eyes, %.3f px slanted\n", rms[0], rms[1]);
  EXPECT_LT(rms[1], 0.8 * rms[0]);  // texture everywhere is the mildest case
}

TEST(Depth, SurfacesWithoutTextureAreMarkedUnknown) {
  const CameraModel camera = test_camera();
  TestStereoScene scene;
  scene.add({0, 0, 0.5}, {3, 0, 0}, {0, 3, 0});
  scene.add({0, 0, 0.4}, {0.24, 0, 0}, {0, 0.2, 0}, 0);  // 114 x 95 px in the middle
  DepthFinder finder;
  DepthImage depth;
  ASSERT_TRUE(finder.find(scene.pictures(camera, 1, 3), test_info(camera), depth));
  // Only noise there, of 1 code: what is still called known would be chance.
  int known = 0, all = 0;
  for (int v = 90; v < 150; ++v) {
    for (int u = 120; u < 200; ++u, ++all) known += depth.known(u, v) ? 1 : 0;
  }
  EXPECT_LT(known, all / 20) << "of " << all;
  EXPECT_NEAR(depth.depth_m(260, 40), 0.5, 0.5 * 0.6 / 15.2);
  EXPECT_TRUE(std::isnan(depth.depth_m(0, 0)));  // the right eye does not see it
}

TEST(Depth, PointsStandBeforeTheEyeAndBeforeTheFoot) {
  const double height = 0.3, tilt = 0.6;
  const CameraModel camera = test_camera();
  const TestStereoScene scene = test_room(height, tilt);
  FrameInfo info = test_info(camera);
  info.posture_known = true;
  // Optical axes in the foot frame (x forward, y left, z up).
  info.foot_from_eye.linear().col(0) = Eigen::Vector3d(0, -1, 0);
  info.foot_from_eye.linear().col(1) = Eigen::Vector3d(-std::sin(tilt), 0, -std::cos(tilt));
  info.foot_from_eye.linear().col(2) = Eigen::Vector3d(std::cos(tilt), 0, -std::sin(tilt));
  info.foot_from_eye.translation() = Eigen::Vector3d(0.02, 0.02, height);
  std::vector<int> patch;
  DepthImage depth = scene.truth(camera, patch);
  depth.info = info;
  depth.disparity_px[0] = 0;
  PointCloud eye, foot;
  point_cloud(depth, eye);
  ASSERT_TRUE(point_cloud_before_foot(depth, foot));
  ASSERT_EQ(foot.points.size(), 320u * 240);
  EXPECT_TRUE(foot.points[0].array().isNaN().all());
  const Eigen::Vector3f& p = eye.points[200 * 320 + 60];
  EXPECT_NEAR(p.x() / p.z() * camera.fx + camera.cx, 60, 1e-3);
  EXPECT_NEAR(p.y() / p.z() * camera.fy + camera.cy, 200, 1e-3);
  int floor = 0;
  for (std::size_t i = 1; i < foot.points.size(); ++i) {
    if (patch[i] == 0) {
      ++floor;
      ASSERT_NEAR(foot.points[i].z(), 0, 1e-5);
    }
    if (patch[i] == 3) {
      ASSERT_NEAR(foot.points[i].z(), 0.08, 1e-5);  // a box's top
      ASSERT_GT(foot.points[i].y(), 0);             // on the left
    }
  }
  EXPECT_GT(floor, 10000);
  depth.info.posture_known = false;
  const auto unknown = point_cloud_before_foot(depth, foot);
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("posture"), std::string::npos);
}

TEST(Depth, PicturesThatHaveNoneAreErrors) {
  const CameraModel camera = test_camera();
  const Image good = test_room().pictures(camera, 0, 1).left;
  const auto message = [&](const Image& left, const Image& right, const CameraModel& model,
                           const DepthOptions& options = {}) {
    DepthFinder finder(options);
    DepthImage depth;
    const auto found = finder.find({left, right}, test_info(model), depth);
    return found ? std::string("no error") : found.error().message;
  };
  const auto says = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos ? testing::AssertionSuccess()
                                                : testing::AssertionFailure() << text;
  };
  EXPECT_EQ(message(good, good, camera), "no error");
  EXPECT_TRUE(says(message({}, good, camera), "left picture is empty"));
  EXPECT_TRUE(says(message(good, {}, camera), "right picture is empty"));
  Image cut = good;
  cut.rgb.resize(1000);
  EXPECT_TRUE(says(message(good, cut, camera), "truncated"));
  EXPECT_TRUE(says(message({-320, 240, good.rgb}, good, camera), "empty"));
  EXPECT_TRUE(says(message({1 << 30, 1 << 30, good.rgb}, good, camera), "8192"));
  const Image tiny = plain_picture(8, 8, kTestGrey), half = plain_picture(160, 120, kTestGrey);
  EXPECT_TRUE(says(message(tiny, tiny, test_camera(8, 8)), "too few"));
  EXPECT_TRUE(says(message(good, half, camera), "one size"));
  EXPECT_TRUE(
      says(message(good, good, test_camera(160, 120)), "calibration for the size of the pictures"));
  const Image plain = plain_picture(320, 240, kTestGrey);
  EXPECT_TRUE(says(message(plain, good, camera), "left picture has a single color"));
  EXPECT_TRUE(says(message(good, plain, camera), "right picture has a single color"));
  CameraModel wrong = camera;
  wrong.baseline_m = 0;
  EXPECT_TRUE(says(message(good, good, wrong), "no baseline"));
  wrong = camera;
  wrong.fx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(says(message(good, good, wrong), "focal length"));
  EXPECT_TRUE(says(message(good, good, camera, {.block_px = 14}), "block_px"));
  EXPECT_TRUE(says(message(good, good, camera, {.nearest_m = 0}), "nearest_m"));
  EXPECT_TRUE(says(message(good, good, camera, {.nearest_m = 0.01}), "increase nearest_m"));
}

// An edge at a disparity of 20 px that falls by `slope` rows a column, in the right picture `up` px higher
// than rectified. Of its blocks how many have depth, and how many of them within a pixel.
struct EdgeScore {
  int known = 0, good = 0;
};
EdgeScore edge_score(double slope, double up, bool vectors) {
  const CameraModel camera = test_camera();
  GreyPicture pictures[2];
  std::vector<std::uint8_t> grey[2];
  TestRandom random(3);
  for (const int side : {0, 1}) {
    for (int v = 0; v < 240; ++v) {
      for (int u = 0; u < 320; ++u) {
        const double over = v + side * up - 120 - slope * (u + side * 20 - 160);
        const double noise = static_cast<double>(random.next() % 3) - 1;
        grey[side].push_back(static_cast<std::uint8_t>(128 + 60 * std::tanh(over / 1.5) + noise));
      }
    }
    pictures[side] = {320, 240, grey[side]};
  }
  DepthFinder finder({.slants = 0, .vectors = vectors});
  DepthImage depth;
  EXPECT_TRUE(finder.find(pictures[0], pictures[1], test_info(camera), depth));
  EdgeScore s;
  for (const float d : depth.disparity_px) {
    if (d <= 0) continue;
    ++s.known;
    s.good += std::abs(d - 20) < 1 ? 1 : 0;
  }
  return s;
}

// Along an edge all points look alike, so one that runs along the rows fixes no disparity: a third of a pixel
// between the eyes' rows would move it by several.
TEST(Depth, EdgesAlongTheRowsHaveNone) {
  for (const bool vectors : {false, true}) {
    const EdgeScore flat = edge_score(0.12, 0.3, vectors), steep = edge_score(0.5, 0.3, vectors);
    EXPECT_EQ(flat.known, 0);
    EXPECT_GT(steep.known, 1500);
    EXPECT_GT(steep.good, 0.98 * steep.known);
  }
}

// Bytes without sense, and pictures that have nothing to do with each other.
TEST(Depth, NoiseHasHardlyAnyDepth) {
  const CameraModel camera = test_camera();
  StereoImages pair{plain_picture(320, 240, kTestGrey), plain_picture(320, 240, kTestGrey)};
  TestRandom random(8);
  for (Image* image : {&pair.left, &pair.right}) {
    for (auto& byte : image->rgb) byte = static_cast<std::uint8_t>(random.next());
  }
  DepthFinder finder;
  DepthImage depth;
  ASSERT_TRUE(finder.find(pair, test_info(camera), depth));
  const auto known = std::count_if(depth.disparity_px.begin(), depth.disparity_px.end(),
                                   [](float d) { return d > 0; });
  EXPECT_LT(known, 320 * 240 / 10);
}

}  // namespace
}  // namespace kaz::vision
