// The ball's centre, radius and distance on pictures computed from the rays.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/ball.h"

#include <gtest/gtest.h>

#include "vision/color/cone.h"
#include "vision/image/pictures_testing.h"

namespace kaz::vision {
namespace {

constexpr double kRadius = 0.020;

BallObservation look(const Image& image, const CameraModel& camera) {
  return BallFinder({}).detect(image, test_info(camera));
}

// At pixel (u, v), `distance` from the lens.
Eigen::Vector3d place(const CameraModel& camera, double u, double v, double distance) {
  return distance *
         Eigen::Vector3d((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1).normalized();
}

TEST(Cone, FitsExactRaysExactly) {
  const Eigen::Vector3d axis = Eigen::Vector3d(0.3, -0.2, 1).normalized();
  const Eigen::Vector3d x = axis.unitOrthogonal(), y = axis.cross(x);
  for (const double half_angle : {0.004, 0.05, 0.5}) {
    for (const double arc : {6.28, 2.0}) {
      std::vector<Eigen::Vector3d> rays;
      for (int i = 0; i < 40; ++i) {
        const double turn = arc * i / 40;
        rays.push_back(std::cos(half_angle) * axis +
                       std::sin(half_angle) * (std::cos(turn) * x + std::sin(turn) * y));
      }
      rays.push_back(Eigen::Vector3d(0.9, 0.1, 1).normalized());  // a stray one
      const std::optional<Cone> cone = fit_cone(rays, 1e-5);
      ASSERT_TRUE(cone) << half_angle << " " << arc;
      EXPECT_NEAR(cone->half_angle, half_angle, 1e-7);
      EXPECT_NEAR((cone->axis - axis).norm(), 0, 1e-7);
    }
  }
}

TEST(Cone, RefusesRaysThatDetermineNone) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  EXPECT_FALSE(fit_cone({}, 1e-3));
  EXPECT_FALSE(fit_cone(std::vector<Eigen::Vector3d>(20, z), 1e-3));
  EXPECT_FALSE(fit_cone(std::vector<Eigen::Vector3d>{z, z, z}, 1e-3));
}

TEST(Cone, EllipseAxesAgreeWithTangents) {
  // Towards the side of the picture at angle t the ellipse reaches from tan(t - a) to tan(t + a).
  const double t = 0.6, a = 0.05;
  const Cone cone{{std::sin(t), 0, std::cos(t)}, a};
  const auto axes = ellipse_axes(cone);
  ASSERT_TRUE(axes);
  EXPECT_NEAR(axes->along, 0.5 * (std::tan(t + a) - std::tan(t - a)), 1e-12);
  EXPECT_FALSE(ellipse_axes({{std::sin(1.55), 0, std::cos(1.55)}, a}));
}

TEST(BallFinder, SubPixelOnAntiAliasedSpheres) {
  const CameraModel camera = test_camera();
  TestRandom random(3);
  for (int i = 0; i < 60; ++i) {
    const double distance = 0.15 + 0.65 * random.unit();
    const double u = 40 + 240 * random.unit(), v = 40 + 160 * random.unit();
    Image image = plain_picture(320, 240, kTestGrey);
    paint_sphere(image, camera, place(camera, u, v, distance), kRadius, kTestRed);
    const BallObservation ball = look(image, camera);
    ASSERT_TRUE(ball.found) << u << " " << v << " " << distance;
    EXPECT_NEAR(ball.center_u, u, 0.1);
    EXPECT_NEAR(ball.center_v, v, 0.1);
    EXPECT_NEAR(ball.distance_m, distance, 0.015 * distance);
    EXPECT_GT(ball.confidence, 0.85);
    EXPECT_NEAR((ball.position() - place(camera, u, v, distance)).norm(), 0, 0.016 * distance);
  }
}

TEST(BallFinder, CutAtTheEdgeOfThePicture) {
  const CameraModel camera = test_camera();
  // 0.25 m: about 15 px radius; centres from 5 px inside to 4 px outside the picture.
  for (const auto& [u, v] : {std::pair{5.0, 120.0},
                             {-4.0, 100.0},
                             {322.0, 60.0},
                             {160.0, 237.0},
                             {150.0, -3.0},
                             {4.0, 4.0},
                             {315.0, 236.0}}) {
    Image image = plain_picture(320, 240, kTestGrey);
    paint_sphere(image, camera, place(camera, u, v, 0.25), kRadius, kTestRed);
    const BallObservation ball = look(image, camera);
    ASSERT_TRUE(ball.found) << u << " " << v;
    EXPECT_NEAR(ball.center_u, u, 0.5);
    EXPECT_NEAR(ball.center_v, v, 0.5);
    EXPECT_NEAR(ball.distance_m, 0.25, 0.03 * 0.25);
  }
}

TEST(BallFinder, HiddenInPart) {
  const CameraModel camera = test_camera();
  Image image = plain_picture(320, 240, kTestGrey);
  paint_sphere(image, camera, place(camera, 160, 120, 0.2), kRadius, kTestRed);
  // A grey bar over the lowest third: 19 px radius, covered from 6 px below the centre.
  for (int v = 126; v < 150; ++v) {
    for (int u = 130; u < 190; ++u) {
      std::uint8_t* p = &image.rgb[static_cast<std::size_t>(v * 320 + u) * 3];
      p[0] = p[1] = p[2] = 90;
    }
  }
  const BallObservation ball = look(image, camera);
  ASSERT_TRUE(ball.found);
  EXPECT_NEAR(ball.center_u, 160, 0.3);
  EXPECT_NEAR(ball.center_v, 120, 0.5);
  EXPECT_NEAR(ball.distance_m, 0.2, 0.03 * 0.2);
  EXPECT_LT(ball.confidence, 0.9);
}

TEST(BallFinder, AHighlightIsNoHole) {
  const CameraModel camera = test_camera();
  Image image = plain_picture(320, 240, kTestGrey);
  paint_sphere(image, camera, place(camera, 150, 110, 0.2), kRadius, kTestRed);
  paint_sphere(image, camera, place(camera, 146, 105, 0.2), 0.003, {255, 240, 235});
  const BallObservation ball = look(image, camera);
  ASSERT_TRUE(ball.found);
  EXPECT_NEAR(ball.center_u, 150, 0.1);
  EXPECT_NEAR(ball.distance_m, 0.2, 0.015 * 0.2);
}

// As the head turns while the picture is exposed: the ball painted along `smear_px` to the right.
Image smeared(const CameraModel& camera, double u, double v, double distance, int smear_px) {
  std::vector<int> sum;
  const int steps = 2 * smear_px + 1;  // half a pixel each
  for (int i = 0; i < steps; ++i) {
    Image image = plain_picture(camera.width, camera.height, kTestGrey);
    paint_sphere(image, camera, place(camera, u + 0.5 * i - 0.5 * smear_px, v, distance), kRadius,
                 kTestRed);
    sum.resize(image.rgb.size());
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += image.rgb[k];
  }
  Image image{camera.width, camera.height, {}};
  for (const int s : sum) image.rgb.push_back(static_cast<std::uint8_t>(s / steps));
  return image;
}

// Rather no ball than one at the wrong distance; the radius is 3.9 to 7.6 px here.
TEST(BallFinder, WideMotionBlurIsNoDistance) {
  CameraModel camera = test_camera();  // the middle of its picture
  camera.width = 100, camera.height = 80, camera.cx = 49.5, camera.cy = 39.5;
  int lost = 0;
  for (const double distance : {0.5, 0.6, 0.7, 0.8, 0.9, 1.0}) {
    for (const double v : {40.0, 40.5}) {
      const BallObservation slow = look(smeared(camera, 50, v, distance, 2), camera);
      ASSERT_TRUE(slow.found) << distance;
      EXPECT_NEAR(slow.distance_m, distance, 0.05 * distance);
      const BallObservation fast = look(smeared(camera, 50, v, distance, 8), camera);
      lost += fast.found ? 0 : 1;
      if (!fast.found) continue;
      EXPECT_NEAR(fast.distance_m, distance, 0.1 * distance);
    }
  }
  EXPECT_GT(lost, 0);
}

TEST(BallFinder, PrefersTheRoundRegionToALargerSquare) {
  const CameraModel camera = test_camera();
  Image image = plain_picture(320, 240, kTestGrey);
  paint_sphere(image, camera, place(camera, 60, 60, 0.3), kRadius, kTestRed);
  for (int v = 130; v < 170; ++v) {
    for (int u = 150; u < 300; ++u) {
      std::uint8_t* p = &image.rgb[static_cast<std::size_t>(v * 320 + u) * 3];
      p[0] = 215;
      p[1] = 25;
      p[2] = 20;
    }
  }
  const BallObservation ball = look(image, camera);
  ASSERT_TRUE(ball.found);
  EXPECT_NEAR(ball.center_u, 60, 0.2);
}

TEST(BallFinder, OtherColorsAreNoBall) {
  const CameraModel camera = test_camera();
  for (const TestColor& color : {TestColor{240, 140, 20},
                                 {40, 170, 60},
                                 {30, 60, 200},
                                 {230, 220, 60},
                                 {200, 40, 200},
                                 {60, 60, 60}}) {
    Image image = plain_picture(320, 240, kTestGrey);
    paint_sphere(image, camera, place(camera, 160, 120, 0.3), kRadius, color);
    const BallObservation ball = look(image, camera);
    EXPECT_FALSE(ball.found);
    EXPECT_FALSE(ball.error);
  }
}

TEST(BallFinder, HostilePictures) {
  const CameraModel camera = test_camera();
  EXPECT_TRUE(look(Image{}, camera).error.has_value());
  EXPECT_TRUE(look(plain_picture(10, 10, kTestRed), camera).error.has_value());  // another size
  EXPECT_TRUE(look(Image{320, 240, std::vector<std::uint8_t>(100)}, camera).error.has_value());
  CameraModel no_focus = camera;
  no_focus.fx = 0;
  EXPECT_TRUE(look(plain_picture(320, 240, kTestRed), no_focus).error.has_value());
  for (const TestColor& color :
       {kTestRed, kTestGrey, TestColor{0, 0, 0}, TestColor{255, 255, 255}}) {
    const BallObservation one_color = look(plain_picture(320, 240, color), camera);
    EXPECT_FALSE(one_color.found);
    EXPECT_FALSE(one_color.error);
    const BallObservation one_pixel = look(plain_picture(1, 1, color), test_camera(1, 1));
    EXPECT_FALSE(one_pixel.found);
    EXPECT_FALSE(one_pixel.error);
  }
  // Noise of all colours: no crash, and no ball.
  TestRandom random(4);
  for (int i = 0; i < 20; ++i) {
    Image noise = plain_picture(320, 240, kTestGrey);
    for (std::uint8_t& c : noise.rgb) c = static_cast<std::uint8_t>(random.next());
    EXPECT_FALSE(look(noise, camera).found);
  }
}

}  // namespace
}  // namespace kaz::vision
