// Statistics of vision modules in results.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision/report.h"

#include <gtest/gtest.h>

namespace kaz::tools {
namespace {

// A run without pictures measures no vision; one with a picture does.
TEST(ModuleStatistics, AreOfModulesThatGotFrames) {
  vision::Pipeline pipeline({vision::Pace::lockstep, Time(0)});
  ASSERT_TRUE(add_modules(VisionOptions{}, pipeline));
  EXPECT_EQ(module_statistics_json(pipeline), nlohmann::ordered_json::object());
  EXPECT_EQ(module_statistics_text(pipeline), "");

  vision::FrameInfo info;
  info.camera.width = 32;
  info.camera.height = 24;
  vision::StereoImages images;
  for (vision::Image* image : {&images.left, &images.right}) {
    image->width = 32;
    image->height = 24;
    image->rgb.assign(3 * 32 * 24, 100);
  }
  pipeline.submit(vision::stereo_pair(std::move(info), std::move(images)));
  pipeline.finish();
  const auto json = module_statistics_json(pipeline);
  ASSERT_TRUE(json.contains("color")) << json;
  EXPECT_EQ(json["color"]["frames"].get<int>() + json["color"]["failed"].get<int>(), 1) << json;
}

}  // namespace
}  // namespace kaz::tools
