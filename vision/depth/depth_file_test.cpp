// Depth files: round trip.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "shared/picture/png_testing.h"
#include "vision/depth/stereo_testing.h"

namespace kaz::vision {
namespace {

DepthImage small_depth() {
  DepthImage depth;
  depth.width = 3;
  depth.height = 2;
  depth.info.camera = {3, 2, 100, 100, 1, 0.5, 0.1};
  depth.disparity_px = {10, 0, 0.1F, 8.3F, 100, 0.5F};  // 1 m, none, 100 m, 1.205, 0.1, 20 m
  return depth;
}

TEST(DepthFile, PngHoldsMillimetres) {
  const auto bytes = depth_png(small_depth());
  ASSERT_TRUE(bytes);
  const auto png = picture::stored_png(*bytes);
  ASSERT_TRUE(png);
  EXPECT_EQ(png->width, 3);
  EXPECT_EQ(png->height, 2);
  EXPECT_EQ(png->bits, 16);
  EXPECT_EQ(png->channels, 1);
  EXPECT_FALSE(png->gamma);  // millimetres are no light
  std::vector<int> codes;
  for (std::size_t i = 0; i + 1 < png->samples.size(); i += 2)
    codes.push_back(png->samples[i] << 8 | png->samples[i + 1]);
  EXPECT_EQ(codes, (std::vector<int>{1000, 0, 0, 1205, 100, 20000}));  // 100 m does not fit
  EXPECT_FALSE(depth_png(DepthImage{}));
}

TEST(DepthFile, PlyHoldsTheKnownPointsWithTheirColours) {
  PointCloud cloud;
  point_cloud(small_depth(), cloud);
  Image colors{3, 2, std::vector<std::uint8_t>(18)};
  for (std::size_t i = 0; i < 18; ++i) colors.rgb[i] = static_cast<std::uint8_t>(i);
  const auto bytes = points_ply(cloud, colors);
  ASSERT_TRUE(bytes);
  const std::string text(bytes->begin(), bytes->end());
  EXPECT_NE(text.find("element vertex 5\n"), std::string::npos) << text;
  const std::size_t body = text.find("end_header\n") + std::strlen("end_header\n");
  ASSERT_EQ(text.size() - body, 5u * 15);
  // The fourth pixel, (0, 1): the third that is known.
  float xyz[3];
  std::memcpy(xyz, bytes->data() + body + 2 * 15,
              sizeof xyz);  // tests run on little-endian machines
  EXPECT_FLOAT_EQ(xyz[2], 10 / 8.3F);
  EXPECT_FLOAT_EQ(xyz[0], -1 * xyz[2] / 100);
  EXPECT_FLOAT_EQ(xyz[1], 0.5F * xyz[2] / 100);
  EXPECT_EQ((*bytes)[body + 2 * 15 + 12], 9);  // red of pixel 3
  colors.width = 2;
  EXPECT_FALSE(points_ply(cloud, colors));
}

}  // namespace
}  // namespace kaz::vision
