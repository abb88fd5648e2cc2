// Pictures against the pinhole model, determinism, and what goes wrong.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/renderer_kind.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "sim/render/camera.h"
#include "sim/render/scenes_testing.h"

namespace kaz::sim {
namespace {

class Renderers : public testing::TestWithParam<RendererKind> {
 protected:
  static std::unique_ptr<Renderer> renderer_for(const Scene& scene) {
    Result<std::unique_ptr<Renderer>> renderer = maker_of(GetParam())();
    EXPECT_TRUE(renderer.has_value());
    const Result<void> set = (*renderer)->set_scene(scene);
    EXPECT_TRUE(set.has_value()) << set.error().message;
    return std::move(*renderer);
  }
};

vision::Image draw(Renderer& renderer, const ScenePose& pose, const View& view) {
  vision::Image picture;
  const Result<void> drawn = renderer.render(pose, view, picture);
  EXPECT_TRUE(drawn.has_value()) << drawn.error().message;
  return picture;
}

// Centroid and extent of the pixels in which red leads by far.
struct Blob {
  double u = 0, v = 0;
  int area = 0;
  double radius() const { return std::sqrt(area / 3.14159265358979323846); }
};

Blob red_blob(const vision::Image& p) {
  Blob blob;
  for (int v = 0; v < p.height; ++v) {
    for (int u = 0; u < p.width; ++u) {
      const std::uint8_t* c = &p.rgb[static_cast<std::size_t>(v * p.width + u) * 3];
      if (c[0] < 30 || c[0] < 2 * c[1] || c[0] < 2 * c[2]) continue;
      blob.u += u;
      blob.v += v;
      ++blob.area;
    }
  }
  if (blob.area > 0) {
    blob.u /= blob.area;
    blob.v /= blob.area;
  }
  return blob;
}

// The outline of a sphere is an ellipse whose axes and centre follow from the cone of rays around
// it.
struct Outline {
  double u, v, mean_radius;
};

Outline outline_of_sphere(const View& view, const Eigen::Vector3d& center, double radius) {
  const Eigen::Vector3d c = view.world_from_optical.inverse() * center;
  // With the centre at distance rho from the optical axis: rays in the plane of both, at the angles
  // theta -+ alpha, end at f tan(theta -+ alpha), the two ends of the ellipse's long axis.
  const double rho = c.head<2>().norm(), theta = std::atan2(rho, c.z());
  const double alpha = std::asin(radius / c.norm()), f = view.camera.fx;
  const double near = f * std::tan(theta - alpha), far = f * std::tan(theta + alpha);
  const double along = 0.5 * (far - near), middle = 0.5 * (far + near);
  // Half the short axis: b^2 = sin^2(alpha) / (cos^2(alpha) - sin^2(theta)), in units of f.
  const double across =
      f * std::sin(alpha) / std::sqrt(std::pow(std::cos(alpha), 2) - std::pow(std::sin(theta), 2));
  const Eigen::Vector2d direction =
      rho > 0 ? Eigen::Vector2d(c.head<2>() / rho) : Eigen::Vector2d(0, 0);
  return {view.camera.cx + middle * direction.x(), view.camera.cy + middle * direction.y(),
          std::sqrt(along * across)};
}

TEST(Pinhole, FocalLengthFromTheHorizontalView) {
  // 80 degrees over 320 pixels: 160 / tan(40 degrees) = 190.68.
  const vision::CameraModel p = camera_of_view(320, 240, 80 * 3.14159265358979323846 / 180);
  EXPECT_NEAR(p.fx, 190.68, 0.005);
  EXPECT_EQ(p.fx, p.fy);
  EXPECT_EQ(p.cx, 159.5);
  EXPECT_EQ(p.cy, 119.5);
}

TEST_P(Renderers, SphereAgreesWithThePinhole) {
  TestScene s;
  const int ball = s.add_ball({0.4, 0, 0.02});
  const auto renderer = renderer_for(s.scene);
  const View view = eye_view();
  for (const Eigen::Vector3d& at :
       {Eigen::Vector3d(0.4, 0, 0.02), Eigen::Vector3d(0.30, 0.12, 0.05),
        Eigen::Vector3d(0.55, -0.25, 0.02), Eigen::Vector3d(0.25, 0, 0.10)}) {
    s.pose.frames[static_cast<std::size_t>(ball)].translation() = at;
    const Blob blob = red_blob(draw(*renderer, s.pose, view));
    const Outline expected = outline_of_sphere(view, at, 0.02);
    EXPECT_NEAR(blob.u, expected.u, 0.3);
    EXPECT_NEAR(blob.v, expected.v, 0.3);
    EXPECT_NEAR(blob.radius(), expected.mean_radius, 0.3);
  }
}

TEST_P(Renderers, MarkersFallOnTheirPixels) {
  // A sphere of two pixels' radius, all over the picture.
  TestScene s;
  const int marker = s.add_ball({1, 0, 0}, kRedBall, 0.004);
  const auto renderer = renderer_for(s.scene);
  View view = eye_view(640);
  view.samples_per_axis = 3;
  for (double u = 20; u < 640; u += 149) {
    for (double v = 20; v < 480; v += 109.3) {
      const double depth = 0.6;
      const Eigen::Vector3d at =
          view.world_from_optical * Eigen::Vector3d(depth * (u - view.camera.cx) / view.camera.fx,
                                                    depth * (v - view.camera.cy) / view.camera.fy,
                                                    depth);
      s.pose.frames[static_cast<std::size_t>(marker)].translation() = at;
      const Blob blob = red_blob(draw(*renderer, s.pose, view));
      ASSERT_GT(blob.area, 0) << u << " " << v;
      EXPECT_NEAR(blob.u, u, 0.3);
      EXPECT_NEAR(blob.v, v, 0.3);
    }
  }
}

TEST_P(Renderers, DisparityIsFocalLengthTimesBaselineOverDepth) {
  TestScene s;
  s.add_ball({0.5, 0.02, 0.3});
  const auto renderer = renderer_for(s.scene);
  View left = eye_view(640), right = left;
  left.samples_per_axis = right.samples_per_axis = 2;
  left.world_from_optical =
      look_at({0.03, 0.5 * kEyeBaseline_m, 0.3}, {1, 0.5 * kEyeBaseline_m, 0.3});
  right.world_from_optical = left.world_from_optical * Eigen::Translation3d(kEyeBaseline_m, 0, 0);
  const Blob l = red_blob(draw(*renderer, s.pose, left)),
             r = red_blob(draw(*renderer, s.pose, right));
  const double depth = 0.5 - 0.030;
  // 381.36 px * 0.040 m / 0.47 m = 32.5 px; the ellipses' middles differ from the centres by less
  // than 0.1.
  EXPECT_NEAR(l.u - r.u, left.camera.fx * 0.040 / depth, 0.3);
  EXPECT_NEAR(l.v, r.v, 0.1);
}

TEST_P(Renderers, TheTopOfThePictureIsTheTopOfTheScene) {
  TestScene s;
  s.add_ball({0.5, 0.1, 0.4});
  View view = eye_view();
  view.world_from_optical = look_at({0, 0, 0.3}, {1, 0, 0.3});
  const Blob blob = red_blob(draw(*renderer_for(s.scene), s.pose, view));
  ASSERT_GT(blob.area, 0);
  EXPECT_LT(blob.v, view.camera.cy);  // above
  EXPECT_LT(blob.u, view.camera.cx);  // y is to the left
}

TEST_P(Renderers, NearSurfacesHideFarOnes) {
  TestScene s;
  s.add_ball({0.6, 0, 0.3});
  s.add(Shape::Kind::box, {0.02, 0.2, 0.2}, {0.4, 0, 0.3}, {0.2F, 0.3F, 0.8F});
  View view = eye_view();
  view.world_from_optical = look_at({0, 0, 0.3}, {1, 0, 0.3});
  const auto renderer = renderer_for(s.scene);
  EXPECT_EQ(red_blob(draw(*renderer, s.pose, view)).area, 0);
  s.pose.frames[2].translation().z() = 0.8;
  EXPECT_GT(red_blob(draw(*renderer, s.pose, view)).area, 50);
}

TEST_P(Renderers, ABallCastsAShadowOnTheGround) {
  TestScene s;
  s.add_ground("");
  const int ball = s.add_ball({0.4, 0, 0.02});
  const auto renderer = renderer_for(s.scene);
  const View view = eye_view();
  const vision::Image on = draw(*renderer, s.pose, view);
  s.pose.frames[static_cast<std::size_t>(ball)].translation().z() = 5;
  const vision::Image off = draw(*renderer, s.pose, view);
  // From the centre the key light's ray goes on (-0.55, 0.50, -1): it meets the ground 0.011 m
  // behind and 0.010 m to the left. That is under the ball; a ray past its left side lands further
  // left.
  const Eigen::Vector2d at = project(view, {0.4 - 0.015, 0.03, 0});
  const auto brightness = [&](const vision::Image& p) {
    const auto u = static_cast<int>(std::lround(at.x())), v = static_cast<int>(std::lround(at.y()));
    return p.rgb[static_cast<std::size_t>(v * p.width + u) * 3 + 1];
  };
  EXPECT_LT(brightness(on) + 25, brightness(off));
}

TEST_P(Renderers, SamePictureBitForBit) {
  const TestScene s = table_scene();
  const View view = eye_view();
  const auto first = renderer_for(s.scene);
  const vision::Image a = draw(*first, s.pose, view);
  // Another pose, another size and another renderer in between change nothing.
  TestScene moved = s;
  moved.pose.frames[2].translation().x() += 0.1;
  draw(*first, moved.pose, eye_view(640));
  const auto second = renderer_for(s.scene);
  const vision::Image b = draw(*second, s.pose, view);
  const vision::Image c = draw(*first, s.pose, view);
  EXPECT_EQ(a.rgb, b.rgb);
  EXPECT_EQ(a.rgb, c.rgb);
}

TEST_P(Renderers, MayMoveToAnotherThread) {
  const TestScene s = table_scene();
  const auto renderer = renderer_for(s.scene);
  const vision::Image here = draw(*renderer, s.pose, eye_view());
  vision::Image there;
  std::thread([&] { there = draw(*renderer, s.pose, eye_view()); }).join();
  EXPECT_EQ(here.rgb, there.rgb);
}

TEST_P(Renderers, TwoThreadsDrawAtOnce) {
  const TestScene s = table_scene();
  vision::Image pictures[2];
  {
    std::vector<std::jthread> threads;
    for (vision::Image& picture : pictures) {
      threads.emplace_back([&] {
        const auto renderer = renderer_for(s.scene);
        for (int i = 0; i < 5; ++i) picture = draw(*renderer, s.pose, eye_view());
      });
    }
  }
  EXPECT_EQ(pictures[0].rgb, pictures[1].rgb);
}

TEST_P(Renderers, RefusesWhatCannotBeDrawn) {
  TestScene s;
  s.add_ball({0.4, 0, 0.02});
  const auto renderer = renderer_for(s.scene);
  vision::Image picture;
  View view = eye_view();
  EXPECT_FALSE(renderer->render(ScenePose{}, view, picture));
  view.camera.width = 0;
  EXPECT_FALSE(renderer->render(s.pose, view, picture));
  view = eye_view();
  view.camera.fx = std::nan("");
  EXPECT_FALSE(renderer->render(s.pose, view, picture));
  view = eye_view();
  view.samples_per_axis = 9;
  EXPECT_FALSE(renderer->render(s.pose, view, picture));
  EXPECT_FALSE(renderer->set_scene(s.scene));  // one scene a renderer
}

TEST_P(Renderers, NamesTheVisualThatItCannotBuild) {
  const auto message = [](const Visual& visual) {
    Scene scene;
    scene.frames = {"world"};
    scene.visuals = {visual};
    const Result<void> set = (*maker_of(GetParam())())->set_scene(scene);
    return set ? std::string() : set.error().message;
  };
  Visual visual;
  visual.name = "foot/sole";
  visual.shape.size = {0.1, 0.1, 0.01};
  EXPECT_EQ(message(visual), "");
  Visual wrong = visual;
  wrong.texture = "marble";
  EXPECT_NE(message(wrong).find("foot/sole"), std::string::npos);
  EXPECT_NE(message(wrong).find("marble"), std::string::npos);
  wrong = visual;
  wrong.frame = 3;
  EXPECT_NE(message(wrong).find("foot/sole"), std::string::npos);
  wrong = visual;
  wrong.shape.size.y() = 0;
  EXPECT_NE(message(wrong).find("foot/sole"), std::string::npos);
  wrong = visual;
  wrong.shape.kind = Shape::Kind::mesh;
  wrong.shape.size.setOnes();
  wrong.shape.mesh_path = "/nonexistent/foot.stl";
  EXPECT_NE(message(wrong).find("/nonexistent/foot.stl"), std::string::npos);
}

TEST_P(Renderers, TheLampTurnsAndDims) {
  TestScene s;
  s.add(Shape::Kind::plane, {6, 6, 0}, {0, 0, 0}, {0.8F, 0.8F, 0.8F});
  s.add(Shape::Kind::box, {0.1, 0.1, 0.1}, {0.6, 0, 0.05}, {0.8F, 0.8F, 0.8F});
  const auto renderer = renderer_for(s.scene);
  View view = eye_view();
  const vision::Image usual = draw(*renderer, s.pose, view);
  const auto red = [&view](const vision::Image& p, const Eigen::Vector3d& at) {
    const Eigen::Vector2d pixel = project(view, at).array().round();
    return static_cast<int>(p.rgb[static_cast<std::size_t>(pixel.y() * p.width + pixel.x()) * 3]);
  };
  // Ground 2.5 cm beside the box, near its front: the shadow is on the side away from the lamp.
  const Eigen::Vector3d left(0.57, 0.075, 0), right(0.57, -0.075, 0);
  EXPECT_LT(red(usual, left), red(usual, right) - 20);
  view.light.to_key = {0, 0.8, 0.6};
  const vision::Image turned = draw(*renderer, s.pose, view);
  EXPECT_GT(red(turned, left), red(turned, right) + 20);
  view.light.key = 0;  // no lamp, no shadow
  const vision::Image overcast = draw(*renderer, s.pose, view);
  EXPECT_NEAR(red(overcast, left), red(overcast, right), 1);
  view.light = {};
  EXPECT_EQ(draw(*renderer, s.pose, view).rgb, usual.rgb);
  view.light.to_key = {1, 0, 0};
  vision::Image none;
  EXPECT_FALSE(renderer->render(s.pose, view, none));
}

TEST_P(Renderers, AnEmptySceneIsBackground) {
  TestScene s;
  const vision::Image p = draw(*renderer_for(s.scene), s.pose, eye_view(16));
  EXPECT_EQ(p.width, 16);
  EXPECT_EQ(p.height, 12);
  EXPECT_EQ(p.rgb.size(), 16U * 12 * 3);
  EXPECT_EQ(red_blob(p).area, 0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Renderers, testing::ValuesIn(kRendererKinds),
                         [](const auto& kind) { return std::string(to_string(kind.param)); });

}  // namespace
}  // namespace kaz::sim
