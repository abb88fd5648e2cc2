// The page's textures are the renderer's, texel by texel, and the markers of a world name them.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/textures.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "shared/picture/png.h"
#include "sim/render/model/texture.h"
#include "sim/runtime/formats/ros_messages.h"

namespace kaz::viewer {
namespace {

TEST(Textures, AreTheRenderersTexelByTexel) {
  const auto files = texture_files();
  ASSERT_TRUE(files.has_value()) << files.error().message;
  const Bytes& text = files->at("/textures.json").bytes;
  const auto periods = nlohmann::json::parse(text.begin(), text.end());
  for (const std::string name : sim::kTextureNames) {
    const auto texture = sim::make_texture(name);
    ASSERT_TRUE(texture.has_value());
    EXPECT_EQ(periods[name], texture->repeat_m) << name;
    const ServedFile& file = files->at("/textures/" + name + ".png");
    EXPECT_EQ(file.type, "image/png");
    const auto picture = picture::decode_png(file.bytes);
    ASSERT_TRUE(picture.has_value()) << name;
    ASSERT_EQ(picture->width, texture->size);
    ASSERT_EQ(picture->height, texture->size);
    const auto& texels = texture->levels.front();
    std::size_t differ = 0;
    for (std::size_t i = 0; i < picture->rgb.size(); ++i)
      differ += picture->rgb[i] != texels[i / 3 * 4 + i % 3];
    EXPECT_EQ(differ, 0u) << name;
  }
}

TEST(Textures, MarkersNameTheTextureOfTheirVisual) {
  sim::Scene scene;
  scene.frames = {"world"};
  sim::Visual floor;
  floor.shape = {sim::Shape::Kind::plane, {8, 8, 0}, nullptr, ""};
  floor.texture = "wood";
  scene.visuals = {floor, sim::Visual{}};
  const auto markers = sim::ros::markers_of(scene, {});
  ASSERT_EQ(markers.size(), 2u);
  EXPECT_EQ(markers[0].texture, "wood");
  EXPECT_EQ(markers[1].texture, "");
  Bytes plain, textured;
  sim::ros::markers(plain, 0, std::span(markers).subspan(1, 1));
  sim::ros::markers(textured, 0, std::span(markers).first(1));
  EXPECT_EQ(textured.size(), plain.size() + 4) << "the text `wood`";
}

}  // namespace
}  // namespace kaz::viewer
