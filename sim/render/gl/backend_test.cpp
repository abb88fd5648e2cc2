// The ways to OpenGL give the same picture, or say why they cannot.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "sim/render/scenes_testing.h"

namespace kaz::sim {
namespace {

Result<vision::Image> draw(const std::string& backend) {
  const TestScene s = table_scene();
  auto renderer = KAZ_TRY(make_renderer(backend));
  KAZ_TRY(renderer->set_scene(s.scene));
  vision::Image picture;
  KAZ_TRY(renderer->render(s.pose, eye_view(), picture));
  return picture;
}

TEST(Backend, EglDrawsWhatOsmesaDraws) {
  const Result<vision::Image> osmesa = draw("osmesa"), egl = draw("egl");
  ASSERT_TRUE(osmesa) << osmesa.error().message;
  ASSERT_TRUE(egl) << egl.error().message;
  // Both are llvmpipe in the same version with the same settings. Should one of them come from
  // another version, an edge may go to the neighbouring pixel: one pixel in a hundred.
  ASSERT_EQ(osmesa->rgb.size(), egl->rgb.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < egl->rgb.size(); ++i)
    different += std::abs(osmesa->rgb[i] - egl->rgb[i]) > 2 ? 1 : 0;
  RecordProperty("bytes_that_differ", static_cast<int>(different));
  EXPECT_LT(different, egl->rgb.size() / 100);
  EXPECT_GT(*std::max_element(egl->rgb.begin(), egl->rgb.end()), 100);  // no black picture
}

TEST(Backend, BothMayDrawInTurn) {
  const TestScene s = table_scene();
  const auto first = make_renderer("osmesa"), second = make_renderer("egl");
  ASSERT_TRUE(first && second);
  ASSERT_TRUE((*first)->set_scene(s.scene) && (*second)->set_scene(s.scene));
  vision::Image a, b, again;
  ASSERT_TRUE((*first)->render(s.pose, eye_view(), a));
  ASSERT_TRUE((*second)->render(s.pose, eye_view(), b));
  ASSERT_TRUE((*first)->render(s.pose, eye_view(), again));
  EXPECT_EQ(a.rgb, again.rgb);
}

TEST(Backend, AnUnknownWayIsNamed) {
  const auto renderer = make_renderer("directx");
  ASSERT_FALSE(renderer);
  EXPECT_EQ(renderer.error().fault, Fault::usage);
  EXPECT_NE(renderer.error().message.find("directx"), std::string::npos);
}

}  // namespace
}  // namespace kaz::sim
