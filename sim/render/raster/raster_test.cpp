// The rasteriser beside OpenGL, each set of instructions beside the others, and awkward scenes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/raster/raster.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "sim/render/scenes_testing.h"

namespace kaz::sim {
namespace {

std::vector<InstructionSet> available_sets() {
  std::vector<InstructionSet> sets;
  for (const auto set : {InstructionSet::plain, InstructionSet::avx2, InstructionSet::avx512}) {
    if (is_available(set)) sets.push_back(set);
  }
  return sets;
}

vision::Image draw(Renderer& renderer, const ScenePose& pose, const View& view) {
  vision::Image picture;
  const Result<void> drawn = renderer.render(pose, view, picture);
  EXPECT_TRUE(drawn) << drawn.error().message;
  return picture;
}

vision::Image draw(std::unique_ptr<Renderer> renderer, const TestScene& s, const View& view) {
  const Result<void> set = renderer->set_scene(s.scene);
  EXPECT_TRUE(set) << set.error().message;
  return draw(*renderer, s.pose, view);
}

// By the widest set; the others must draw the same bytes.
vision::Image raster(const TestScene& s, const View& view) {
  vision::Image first;
  for (const InstructionSet set : available_sets()) {
    const vision::Image picture = draw(make_raster_with(set), s, view);
    EXPECT_EQ(picture.rgb.size(), 3U * static_cast<std::size_t>(picture.width * picture.height));
    if (first.rgb.empty()) first = picture;
    EXPECT_TRUE(picture.rgb == first.rgb) << "set " << static_cast<int>(set);
  }
  return first;
}

vision::Image opengl(const TestScene& s, const View& view) {
  return draw(std::move(*make_opengl_renderer()), s, view);
}

struct Difference {
  double different = 0;  // share of pixels with a channel more than 2 codes apart
  int beside =
      0;  // of those, pixels outside of what the other picture's 3 x 3 pixels around range over
};

Difference difference(const vision::Image& a, const vision::Image& b) {
  Difference found;
  const auto at = [](const vision::Image& p, int u, int v, int c) -> int {
    return p.rgb[static_cast<std::size_t>((v * p.width + u) * 3 + c)];
  };
  int count = 0;
  for (int v = 0; v < a.height; ++v) {
    for (int u = 0; u < a.width; ++u) {
      bool different = false, beside = false;
      for (int c = 0; c < 3; ++c) {
        if (std::abs(at(a, u, v, c) - at(b, u, v, c)) <= 2) continue;
        different = true;
        int low = 255, high = 0;
        for (int y = std::max(v - 1, 0); y <= std::min(v + 1, a.height - 1); ++y) {
          for (int x = std::max(u - 1, 0); x <= std::min(u + 1, a.width - 1); ++x) {
            low = std::min(low, at(b, x, y, c));
            high = std::max(high, at(b, x, y, c));
          }
        }
        beside = beside || at(a, u, v, c) < low - 2 || at(a, u, v, c) > high + 2;
      }
      count += different ? 1 : 0;
      found.beside += beside ? 1 : 0;
    }
  }
  found.different = count / static_cast<double>(a.width * a.height);
  return found;
}

void expect_alike(const TestScene& s, const View& view, const std::string& what,
                  double max_bias = 0.05) {
  const vision::Image ours = raster(s, view), reference = opengl(s, view);
  ASSERT_EQ(ours.rgb.size(), reference.rgb.size()) << what;
  const Difference found = difference(ours, reference);
  EXPECT_LT(found.different, 0.01) << what;
  // Llvmpipe mixes two levels of a texture by another rounding; edges alone differ elsewhere.
  EXPECT_LE(found.beside, ours.width * ours.height / 1000) << what;
  // The mean brightness is the same: nothing is missing, however small.
  double bias = 0;
  for (std::size_t i = 0; i < ours.rgb.size(); ++i) bias += ours.rgb[i] - reference.rgb[i];
  EXPECT_LT(std::abs(bias) / static_cast<double>(ours.rgb.size()), max_bias) << what;
}

TestScene room(const std::string& texture) {
  TestScene s;
  s.add_ground(texture);
  s.add(Shape::Kind::box, {0.10, 0.14, 0.12}, {0.75, -0.30, 0.06}, {0.25F, 0.45F, 0.70F});
  s.add(Shape::Kind::box, {0.08, 0.08, 0.20}, {0.85, 0.35, 0.10}, {0.92F, 0.75F, 0.25F}, "wood");
  s.add(Shape::Kind::cylinder, {0.045, 0.11, 0}, {0.60, 0.42, 0.055}, {0.35F, 0.62F, 0.40F});
  s.add(Shape::Kind::capsule, {0.03, 0.10, 0}, {0.55, -0.1, 0.2}, {0.8F, 0.7F, 0.2F});
  s.add_ball({0.5, -0.2, 0.02}, {0.95F, 0.55F, 0.10F});
  s.add_ball({0.4, 0.05, 0.02});
  s.pose.frames.back().rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  s.pose.frames[3].rotate(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
  return s;
}

View outside_view(int samples) {
  View view;
  view.camera = camera_of_view(240, 180, 0.75);
  view.world_from_optical = look_at({-0.3, 0.9, 0.6}, {0.6, 0, 0.05});
  view.samples_per_axis = samples;
  return view;
}

TEST(Raster, DrawsWhatOpenGlDraws) {
  for (const char* texture : {"", "checker", "wood", "carpet"}) {
    const TestScene s = room(texture);
    const std::string name = std::string("on `") + texture + "`, ";
    expect_alike(s, eye_view(), name + "eye");
    expect_alike(s, eye_view(320, 0.1), name + "level eye");
    for (int samples = 1; samples <= 4; ++samples)
      expect_alike(s, outside_view(samples), name + std::to_string(samples) + " samples");
  }
  expect_alike(table_scene(), eye_view(), "table");
  expect_alike(table_scene(), eye_view(640), "table, 640 px");
}

TEST(Raster, DrawsUnderAnotherLampWhatOpenGlDraws) {
  View view = eye_view();
  view.light.to_key = {0.2, 0.9, 0.3};
  view.light.key = 0.6;
  view.light.shaded = 1.4;
  expect_alike(room("wood"), view, "low lamp");
}

TEST(Raster, ThePairIsTwoPictures) {
  TestScene s = table_scene();
  View left = eye_view(), right = left;
  right.world_from_optical.translate(Eigen::Vector3d(kEyeBaseline_m, 0, 0));
  const auto renderer = std::move(*make_raster_renderer());
  ASSERT_TRUE(renderer->set_scene(s.scene));
  for (int i = 0; i < 3; ++i) {
    s.pose.frames.back().translation().x() -= 0.01;
    const vision::Image one = draw(*renderer, s.pose, left), other = draw(*renderer, s.pose, right);
    EXPECT_EQ(one.rgb, draw(std::move(*make_raster_renderer()), s, left).rgb);
    EXPECT_EQ(other.rgb, draw(std::move(*make_raster_renderer()), s, right).rgb);
  }
}

TEST(Raster, APartIsThatOfTheWholePicture) {
  for (const TestScene& s : {room("wood"), table_scene()}) {
    for (const int samples : {1, 3}) {
      View view = outside_view(samples);
      const vision::Image whole = raster(s, view);
      for (const PicturePart part :
           {PicturePart{0, 0, 240, 180}, {0, 0, 1, 1}, {239, 179, 240, 180}, {33, 20, 190, 131}}) {
        view.part = part;
        const vision::Image drawn = raster(s, view);
        ASSERT_EQ(drawn.rgb.size(), whole.rgb.size());
        for (int v = part.top; v < part.bottom; ++v) {
          const std::size_t first = 3 * static_cast<std::size_t>(v * 240 + part.left);
          const std::size_t end = 3 * static_cast<std::size_t>(v * 240 + part.right);
          ASSERT_TRUE(std::equal(drawn.rgb.begin() + static_cast<std::ptrdiff_t>(first),
                                 drawn.rgb.begin() + static_cast<std::ptrdiff_t>(end),
                                 whole.rgb.begin() + static_cast<std::ptrdiff_t>(first)))
              << "row " << v << " from " << part.left << ", " << samples;
        }
      }
    }
  }
  View view = outside_view(1);
  const auto renderer = std::move(*make_raster_renderer());
  ASSERT_TRUE(renderer->set_scene(room("").scene));
  vision::Image picture;
  for (const PicturePart part : {PicturePart{0, 0, 241, 180}, {5, 5, 5, 6}, {0, -1, 4, 4}}) {
    view.part = part;
    EXPECT_FALSE(renderer->render(room("").pose, view, picture));
  }
}

TEST(Raster, CloseBodiesAndThoseAroundTheEye) {
  TestScene s = room("checker");
  // Walls to the left and right that begin behind the eye, and a bar through the near plane.
  s.add(Shape::Kind::box, {3, 0.02, 0.5}, {0.5, 0.3, 0.25}, {0.7F, 0.5F, 0.4F});
  s.add(Shape::Kind::box, {3, 0.02, 0.5}, {0.5, -0.3, 0.25}, {0.5F, 0.7F, 0.4F}, "carpet");
  s.add(Shape::Kind::cylinder, {0.01, 0.4, 0}, {0.01, 0.01, 0.3}, {0.2F, 0.2F, 0.8F});
  expect_alike(s, eye_view(), "walls");
  // Inside a body only what is outside is seen, as its back faces are not drawn.
  TestScene inside = room("wood");
  inside.add(Shape::Kind::sphere, {0.25, 0, 0}, {0.02, 0.01, 0.3}, {0.2F, 0.2F, 0.8F});
  expect_alike(inside, eye_view(), "inside");
}

TEST(Raster, GroundsBeyondTheFarPlaneAndTheFixedPoint) {
  TestScene s;
  s.add(Shape::Kind::plane, {400, 400, 0}, {0, 0, 0}, {0.5F, 0.6F, 0.5F}, "checker");
  s.add_ball({0.4, 0.05, 0.02});
  expect_alike(s, eye_view(320, 0.05), "large ground");
  View narrow = eye_view(320, 0.6);
  narrow.camera.fx = narrow.camera.fy = 20'000;  // the ground's corners are millions of pixels away
  // Between texels of the pattern, single precision leaves a code open.
  expect_alike(s, narrow, "telephoto", 0.5);
  narrow.camera = eye_view().camera;
  narrow.camera.cx = 20'000;
  expect_alike(s, narrow, "centre outside");
}

TEST(Raster, EmptyScenesAndPicturesOfAnySize) {
  TestScene empty;
  expect_alike(empty, eye_view(), "empty");
  TestScene s = room("checker");
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {1, 37}, {17, 3}, {31, 33}}) {
    View view = eye_view();
    view.camera = camera_of_view(width, height, 1.2);
    for (int samples = 1; samples <= 4; ++samples) {
      view.samples_per_axis = samples;
      const vision::Image ours = raster(s, view), reference = opengl(s, view);
      ASSERT_EQ(ours.rgb.size(), reference.rgb.size());
      for (std::size_t i = 0; i < ours.rgb.size(); ++i)
        EXPECT_NEAR(ours.rgb[i], reference.rgb[i], 6) << width << " x " << height;
    }
  }
  View large = eye_view();  // several bands of rows
  large.camera = camera_of_view(1500, 900, 1.2);
  expect_alike(s, large, "large");
  large.camera = camera_of_view(8192, 512, 1.2);
  EXPECT_EQ(raster(s, large).rgb.size(), 8192U * 512 * 3);
}

// Binary STL.
void write_stl(const std::string& path, const std::vector<std::array<float, 9>>& triangles) {
  std::ofstream file(path, std::ios::binary);
  const std::array<char, 80> header{};
  file.write(header.data(), header.size());
  const auto count = static_cast<std::uint32_t>(triangles.size());
  file.write(reinterpret_cast<const char*>(&count), 4);
  for (const auto& t : triangles) {
    const std::array<float, 3> normal{0, 0, 1};
    file.write(reinterpret_cast<const char*>(normal.data()), 12);
    file.write(reinterpret_cast<const char*>(t.data()), 36);
    file.write("\0", 2);
  }
}

TEST(Raster, DegenerateTriangles) {
  const std::string path = (std::filesystem::temp_directory_path() /
                            ("kaz-raster-" + std::to_string(::getpid()) + ".stl"))
                               .string();
  std::vector<std::array<float, 9>> triangles{
      {0, 0, 0, 0, 0, 0, 0, 0, 0},      // a point
      {0, 0, 0, 1, 0, 0, 2, 0, 0},      // a line
      {0, 0, 0, 1, 0, 0, 1, 1e-7F, 0},  // a sliver
      {-1, -1, 0, 1, -1, 0, 1, 1, 0},   // and one that is seen
      {1e-6F, 0, 0.1F, 2e-6F, 0, 0.1F, 0, 1e-6F, 0.1F}};
  for (int i = 0; i < 400; ++i) {  // a fan of needles
    const auto a = static_cast<float>(i) * 0.0157F;
    triangles.push_back({0, 0, 0.05F, std::cos(a), std::sin(a), 0.05F, std::cos(a + 1e-4F),
                         std::sin(a + 1e-4F), 0.05F});
  }
  write_stl(path, triangles);
  TestScene s;
  Visual visual;
  visual.name = "odd";
  visual.shape.kind = Shape::Kind::mesh;
  visual.shape.size = {0.2, 0.2, 0.2};
  visual.shape.mesh_path = path;
  visual.in_frame.translation() = Eigen::Vector3d(0.4, 0, 0.05);
  s.scene.visuals.push_back(visual);
  expect_alike(s, eye_view(), "eye");
  expect_alike(s, outside_view(2), "outside");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace kaz::sim
