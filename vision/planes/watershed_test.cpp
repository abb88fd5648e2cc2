// Morphology of bits and the watershed beside OpenCV's, on random masks and pictures: equal pixels.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/watershed.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "shared/base/random.hpp"

namespace kaz::vision {
namespace {

// Rectangles and specks; sizes around the 64 pixels of a word.
constexpr std::pair<int, int> kSizes[] = {{1, 1},  {2, 40},   {63, 30}, {64, 50},
                                          {65, 9}, {157, 81}, {320, 64}};

cv::Mat random_mask(int width, int height, Random& random) {
  cv::Mat mask = cv::Mat::zeros(height, width, CV_8U);
  const auto below = [&](int n) {
    return static_cast<int>(random.below(static_cast<std::uint32_t>(n)));
  };
  for (int i = 0; i < 6; ++i)
    cv::rectangle(mask, {below(width), below(height)}, {below(width), below(height)},
                  i % 3 == 2 ? 0 : 1, -1);
  for (int i = 0; i < width * height / 40; ++i)
    mask.at<std::uint8_t>(below(height), below(width)) ^= 1;
  return mask;
}

std::vector<std::uint8_t> bytes_of(const BitImage& image) {
  std::vector<std::uint8_t> bytes;
  for (int v = 0; v < image.height(); ++v)
    for (int u = 0; u < image.width(); ++u)
      bytes.push_back(static_cast<std::uint8_t>(image.row(v)[u / 64] >> (u % 64) & 1));
  return bytes;
}
std::vector<std::uint8_t> bytes_of(const cv::Mat& mask) {
  return {mask.datastart, mask.dataend};
}

TEST(BitImage, DilatesAndErodesAsOpenCv) {
  Random random(3);
  for (const auto& [width, height] : kSizes) {
    for (const int reach : {1, 2, 4, 8, 31, 32, 33, 63, 64}) {
      const cv::Mat mask = random_mask(width, height, random);
      const cv::Mat square = cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U);
      cv::Mat wide, narrow;
      cv::dilate(mask, wide, square);
      cv::erode(mask, narrow, square);
      BitImage image;
      image.pack(mask.data, width, height);
      ASSERT_EQ(bytes_of(image), bytes_of(mask));
      BitImage other = image;
      image.dilate(reach);
      other.erode(reach);
      ASSERT_EQ(bytes_of(image), bytes_of(wide)) << width << " x " << height << ", " << reach;
      ASSERT_EQ(bytes_of(other), bytes_of(narrow)) << width << " x " << height << ", " << reach;
    }
  }
}

TEST(Watershed, IsOpenCvs) {
  Random random(7);
  Watershed watershed;
  std::size_t lines = 0;
  for (int trial = 0; trial < 40; ++trial) {
    for (const auto& [width, height] : kSizes) {
      cv::Mat picture(height, width, CV_8UC3);
      // Few tones make many equal differences, whose order then counts.
      const std::uint32_t tones = trial % 2 == 0 ? 256 : 3;
      for (auto at = picture.datastart; at != picture.dataend; ++at)
        *const_cast<std::uint8_t*>(at) =
            static_cast<std::uint8_t>(random.below(tones) * (255 / (tones - 1)));
      const cv::Mat one = random_mask(width, height, random);
      cv::Mat other = random_mask(width, height, random) & (1 - one);
      cv::Mat markers(height, width, CV_32S);
      for (int i = 0; i < width * height; ++i)
        markers.ptr<int>()[i] = one.data[i] != 0 ? 1 : other.data[i] != 0 ? 2 : 0;
      cv::watershed(picture, markers);
      BitImage first, second;
      first.pack(one.data, width, height);
      second.pack(other.data, width, height);
      const std::vector<std::uint8_t>& label = watershed.grow(picture.data, first, second);
      for (int i = 0; i < width * height; ++i) {
        const int expected = markers.ptr<int>()[i];
        const int found = label[static_cast<std::size_t>(i)] == Watershed::kLine
                              ? -1
                              : label[static_cast<std::size_t>(i)];
        ASSERT_EQ(found, expected) << width << " x " << height << ", " << i << ", trial " << trial;
        lines += found < 0;
      }
    }
  }
  EXPECT_GT(lines, 10000U);
}

}  // namespace
}  // namespace kaz::vision
