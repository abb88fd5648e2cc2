// Lenses, remapping and rectification against their formulas.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/rectify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shared/base/random.hpp"

namespace kaz::vision {
namespace {

Lens wide_lens() {
  return {209, 208, 161.2, 118.4, {-0.18, 0.03, 0.0006, -0.0004, 0.001}};
}

Image noise_picture(int width, int height) {
  Image image{width, height, {}};
  Random random(3);
  for (int i = 0; i < width * height * 3; ++i)
    image.rgb.push_back(static_cast<std::uint8_t>(random.below(256)));
  return image;
}

TEST(Lens, DirectionIsTheInverseOfPixel) {
  const Lens lens = wide_lens();
  for (double u = -5; u < 330; u += 13.7) {
    for (double v = -5; v < 250; v += 11.3) {
      const Eigen::Vector2d back = lens.pixel(lens.direction({u, v}));
      EXPECT_NEAR(back.x(), u, 1e-8);
      EXPECT_NEAR(back.y(), v, 1e-8);
    }
  }
}

TEST(Lens, DistortsAsBrownAndConradyWroteIt) {
  Lens lens{1, 1, 0, 0, {-0.2, 0, 0, 0, 0}};
  EXPECT_DOUBLE_EQ(lens.pixel({0.5, 0}).x(), 0.5 * (1 - 0.2 * 0.25));
  lens.distortion = {0, 0, 0.01, 0, 0};  // p1 moves along y by r^2 + 2 y^2
  EXPECT_DOUBLE_EQ(lens.pixel({0, 0.5}).y(), 0.5 + 0.01 * 0.75);
  EXPECT_DOUBLE_EQ(lens.pixel({0.5, 0}).y(), 0.01 * 0.25);
  lens.distortion = {0, 0, 0, 0.01, 0};  // p2 along x
  EXPECT_DOUBLE_EQ(lens.pixel({0.5, 0}).x(), 0.5 + 0.01 * 0.75);
}

TEST(Remap, TheIdentityKeepsEveryByte) {
  const Image from = noise_picture(37, 23);
  const Remap remap({37, 23}, {37, 23}, [](int u, int v) {
    return Remap::Place{static_cast<double>(u), static_cast<double>(v), 1};
  });
  std::vector<std::uint8_t> rgb;
  remap.apply(from.rgb, rgb);
  // The last column and row come from 127/128 of a step beyond their neighbours.
  for (int v = 0; v < 22; ++v) {
    for (int i = 0; i < 36 * 3; ++i) {
      const auto at = static_cast<std::size_t>(v * 37 * 3 + i);
      ASSERT_EQ(rgb[at], from.rgb[at]) << v << " " << i;
    }
  }
  for (std::size_t i = 0; i < rgb.size(); ++i) EXPECT_NEAR(rgb[i], from.rgb[i], 4);
}

TEST(Remap, IsBilinearAndVectorsChangeNothing) {
  const Image from = noise_picture(64, 48);
  const auto place = [](int u, int v) {
    return Remap::Place{1.37 * u - 1 + 0.05 * v, 1.21 * v - 0.4 + 0.03 * u, 0.7 + 0.006 * u};
  };
  const Remap remap({50, 40}, {64, 48}, place);
  std::vector<std::uint16_t> codes(151), plain(151);
  int compared = 0;
  for (int v = 0; v < 40; ++v) {
    remap.row(from.rgb, v, {0, 50}, codes.data());
    remap.row_plain(from.rgb, v, {0, 50}, plain.data());
    ASSERT_EQ(codes, plain) << v;
    for (int u = 0; u < 50; ++u) {
      const auto [x, y, gain] = place(u, v);
      if (x < -0.5 || y < -0.5 || x > 63.5 || y > 47.5) {
        EXPECT_EQ(codes[static_cast<std::size_t>(3 * u)], 0);
        continue;
      }
      if (x < 0 || y < 0 || x > 62 || y > 46) continue;  // held at the edge
      const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
      const auto code = [&](int i, int j) {
        return static_cast<double>(from.rgb[static_cast<std::size_t>((y0 + j) * 64 + x0 + i) * 3]);
      };
      const double a = x - x0, b = y - y0;
      const double exact = gain * ((1 - b) * ((1 - a) * code(0, 0) + a * code(1, 0)) +
                                   b * ((1 - a) * code(0, 1) + a * code(1, 1)));
      // Half of 1/128 px on each axis, at up to 255 codes a pixel.
      EXPECT_NEAR(codes[static_cast<std::size_t>(3 * u)] / 64.0, exact, 2.1);
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(Remap, RowsOfAnyWidthAreTheSameWithVectors) {
  const Image from = noise_picture(64, 48);
  for (const int width : {1, 2, 3, 16, 51}) {
    const Remap remap({width, 20}, {64, 48}, [](int u, int v) {
      return Remap::Place{1.1 * u + 0.3, 2.1 * v + 0.2, 0.9};
    });
    const auto size = static_cast<std::size_t>(3 * width + 1);
    std::vector<std::uint16_t> codes(size), plain(size), part(size);
    for (int v = 0; v < 20; ++v) {
      remap.row(from.rgb, v, {0, width}, codes.data());
      remap.row_plain(from.rgb, v, {0, width}, plain.data());
      ASSERT_EQ(codes, plain) << width << " " << v;
      for (int first = 0; first < width; first += 4) {
        const int end = std::min(first + 7, width);
        remap.row(from.rgb, v, {first, end}, part.data());
        ASSERT_TRUE(
            std::equal(part.data() + 3 * first, part.data() + 3 * end, plain.data() + 3 * first))
            << width << " " << v << " " << first;
      }
    }
  }
}

TEST(Remap, SourcesAreAllThatCounts) {
  Image from = noise_picture(64, 48);
  const Remap remap({30, 20}, {64, 48}, [](int u, int v) {
    return Remap::Place{8.3 + 1.2 * u + 0.2 * v, 3.4 + 1.5 * v - 0.1 * u, 0.9};
  });
  const std::vector<Remap::Columns> wanted(20, {5, 25});
  const auto sources = remap.sources(wanted);
  std::vector<std::uint16_t> before(20 * 91), after(before.size());
  const auto rows = [&](std::vector<std::uint16_t>& codes) {
    for (int v = 0; v < 20; ++v) remap.row(from.rgb, v, wanted[0], codes.data() + 91 * v);
  };
  rows(before);
  int kept = 0;
  for (int v = 0; v < 48; ++v) {
    const auto [first, end] = sources[static_cast<std::size_t>(v)];
    for (int u = 0; u < 64; ++u) {
      if (u >= first && u < end) {
        ++kept;
      } else {
        for (int c = 0; c < 3; ++c)
          from.rgb[static_cast<std::size_t>(3 * (64 * v + u) + c)] ^= 0xFF;
      }
    }
  }
  rows(after);
  EXPECT_EQ(before, after);
  EXPECT_LT(kept, 40 * 33);  // 20 columns and rows of 1.2 and 1.5 px, aslant by 3 and 2 px
}

TEST(Rectifier, BringsPointsOfBothEyesToOneRow) {
  StereoCalibration calibration;
  calibration.width = 320;
  calibration.height = 240;
  calibration.left.lens = wide_lens();
  calibration.right.lens = wide_lens();
  calibration.right.lens.cy += 2;
  calibration.right.rectified_from_camera =
      Eigen::AngleAxisd(0.01, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  calibration.rectified = {320, 240, 190.68, 190.68, 159.5, 119.5, 0.04};
  const Rectifier rectifier(calibration);
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0.05, 0.1, 0.5), Eigen::Vector3d(-0.2, -0.1, 0.45)}) {
    StereoImages raw, rectified;
    const auto draw = [&](const StereoCalibration::Eye& eye, double baseline, Image& image) {
      const Eigen::Vector3d in_camera =
          eye.rectified_from_camera.transpose() * (point - Eigen::Vector3d(baseline, 0, 0));
      const Eigen::Vector2d at = eye.lens.pixel(in_camera.head<2>() / in_camera.z());
      image = {320, 240, {}};
      for (int v = 0; v < 240; ++v) {
        for (int u = 0; u < 320; ++u) {
          const double r2 = (Eigen::Vector2d(u, v) - at).squaredNorm();
          const auto code = static_cast<std::uint8_t>(std::lround(250 * std::exp(-r2 / 18)));
          image.rgb.insert(image.rgb.end(), 3, code);
        }
      }
    };
    draw(calibration.left, 0, raw.left);
    draw(calibration.right, 0.04, raw.right);
    rectifier.rectify(raw, rectified);
    const auto centre = [](const Image& image) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int v = 0; v < image.height; ++v) {
        for (int u = 0; u < image.width; ++u) {
          const double w = image.rgb[static_cast<std::size_t>(v * image.width + u) * 3];
          sum += w * Eigen::Vector3d(u, v, 1);
        }
      }
      return Eigen::Vector2d(sum.head<2>() / sum.z());
    };
    const Eigen::Vector2d left = centre(rectified.left), right = centre(rectified.right);
    const CameraModel& c = calibration.rectified;
    // A spot of 3 px is bent a little by the lens, which moves its centroid by under 0.1 px.
    EXPECT_NEAR(left.x(), c.fx * point.x() / point.z() + c.cx, 0.15);
    EXPECT_NEAR(left.y(), c.fy * point.y() / point.z() + c.cy, 0.15);
    EXPECT_NEAR(right.y(), left.y(), 0.1);
    EXPECT_NEAR(left.x() - right.x(), c.fx * 0.04 / point.z(), 0.1);
  }
}

}  // namespace
}  // namespace kaz::vision
