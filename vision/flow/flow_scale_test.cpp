// Small pictures and enlarged flow beside OpenCV's; and the search on small pictures beside the search on
// full ones: equal bits.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/flow_scale.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "shared/base/random.hpp"
#include "vision/depth/stereo_testing.h"
#include "vision/flow/flow.h"

namespace kaz::vision {
namespace {

TEST(FlowScale, QuarterIsOpenCvsArea) {
  Random random(1);
  for (const auto& [width, height] : {std::pair{64, 64}, {100, 68}, {320, 240}}) {
    cv::Mat grey(height, width, CV_8U), expected;
    std::vector<std::uint8_t> small(static_cast<std::size_t>(width / 4 * (height / 4)));
    for (const std::uint32_t tones : {256U, 2U}) {  // with two, halves are frequent
      for (int i = 0; i < width * height; ++i)
        grey.data[i] = static_cast<std::uint8_t>(random.below(tones));
      cv::resize(grey, expected, {width / 4, height / 4}, 0, 0, cv::INTER_AREA);
      quarter(grey.data, width, height, small.data());
      for (std::size_t i = 0; i < small.size(); ++i)
        ASSERT_EQ(small[i], expected.data[i]) << width << " x " << height << ", " << i;
    }
  }
}

TEST(FlowScale, EnlargedFlowIsOpenCvs) {
  Random random(2);
  FlowEnlarger enlarger;
  for (const auto& [width, height] : {std::pair{16, 16}, {25, 17}, {80, 60}}) {
    cv::Mat small(height, width, CV_32FC2), expected;
    for (int i = 0; i < 2 * width * height; ++i)
      small.ptr<float>()[i] = static_cast<float>(20 * random.uniform() - 10);
    cv::resize(small, expected, {4 * width, 4 * height});
    expected *= 4;
    std::vector<float> full(static_cast<std::size_t>(32 * width * height));
    enlarger.resize({width, height}, {4 * width, 4 * height});
    enlarger.enlarge(small.ptr<float>(), 4, full.data());
    for (std::size_t i = 0; i < full.size(); ++i)
      ASSERT_EQ(full[i], expected.ptr<float>()[i]) << width << " x " << height << ", " << i;
  }
}

// Also of sizes that the search cannot be given small.
TEST(FlowScale, FlowIsThatOfTheSearchOnFullPictures) {
  for (const auto& [width, height] :
       {std::pair{320, 240}, {400, 300}, {96, 80}, {92, 68}, {64, 64}, {318, 237}, {181, 128}}) {
    CameraModel camera = test_camera(width, height);
    FlowFinder finder;
    FlowImage flow, again;
    std::vector<Image> pictures;
    for (std::uint64_t i = 0; i < 3; ++i) {
      camera.baseline_m = 0.008 * static_cast<double>(i);
      pictures.push_back(test_room().pictures(camera, 2, 3 + 4 * i).right);
    }
    for (std::size_t i = 1; i < pictures.size(); ++i) {
      FrameInfo before = test_info(camera), after = before;
      after.exposure = std::chrono::milliseconds(33);
      ASSERT_TRUE(finder.find(pictures[i - 1], before, pictures[i], after, flow, i > 1));
      ASSERT_TRUE(FlowFinder().find(pictures[i - 1], before, pictures[i], after, again));
      cv::Mat grey[2], expected;
      for (std::size_t k = 0; k < 2; ++k)
        cv::cvtColor(cv::Mat(height, width, CV_8UC3, pictures[i - 1 + k].rgb.data()), grey[k],
                     cv::COLOR_RGB2GRAY);
      cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST)
          ->calc(grey[0], grey[1], expected);
      std::size_t known = 0;
      for (std::size_t k = 0; k < flow.flow_px.size(); ++k) {
        const Eigen::Vector2f &one = flow.flow_px[k], &other = again.flow_px[k];
        ASSERT_EQ(std::isnan(one.x()), std::isnan(other.x())) << k;
        if (std::isnan(one.x())) continue;
        ASSERT_EQ(one, other) << k;
        ASSERT_EQ(one.x(), expected.ptr<float>()[2 * k]) << width << " x " << height << ", " << k;
        ASSERT_EQ(one.y(), expected.ptr<float>()[2 * k + 1])
            << width << " x " << height << ", " << k;
        ++known;
      }
      EXPECT_GT(10 * known, flow.flow_px.size()) << width << " x " << height;
    }
  }
}

}  // namespace
}  // namespace kaz::vision
