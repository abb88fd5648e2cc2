// What the robot's shapes hide, against pictures of it, and of shapes of known size.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/own_body.h"

#include <algorithm>
#include <cstddef>

#include <gtest/gtest.h>

#include "sim/body/world/world.h"
#include "sim/render/camera.h"
#include "sim/render/renderer.h"

namespace kaz::tools {
namespace {

using Eigen::Isometry3d, Eigen::Vector3d;

// A picture of the robot differs from one of the place without it where it hides the place.
TEST(OwnBody, HidesWhatItHidesInAPicture) {
  const auto world = sim::World::load("sim/worlds/empty.sdf", "shared/robot/kaz/kaz.urdf", {});
  ASSERT_TRUE(world) << world.error().message;
  const auto links = (*world)->link_order();
  auto own = OwnBody::make((*world)->scene(), links);
  ASSERT_TRUE(own) << own.error().message;
  own->move((*world)->pose(), Isometry3d::Identity());

  sim::View view;
  view.camera = sim::camera_of_view(160, 160, 0.9);
  view.light.key = 0;  // no shadow
  const auto drawn = [&](const sim::Scene& scene) {
    auto renderer = sim::make_raster_renderer().value();
    vision::Image picture;
    EXPECT_TRUE(renderer->set_scene(scene));
    EXPECT_TRUE(renderer->render((*world)->pose(), view, picture));
    return picture.rgb;
  };
  sim::Scene alone = (*world)->scene();
  std::erase_if(alone.visuals, [&](const sim::Visual& visual) {
    const auto& frame = alone.frames[static_cast<std::size_t>(visual.frame)];
    return std::ranges::find(links, frame) != links.end();
  });
  for (const Vector3d& eye : {Vector3d(0.4, 0.1, 0.3), Vector3d(0.1, -0.3, 0.5)}) {
    view.world_from_optical = sim::look_at(eye, {0, 0, 0.16});
    const auto with = drawn((*world)->scene()), without = drawn(alone);
    int robot = 0, wrong = 0;
    for (int v = 0; v < view.camera.height; ++v) {
      for (int u = 0; u < view.camera.width; ++u) {
        const std::ptrdiff_t pixel = 3 * (std::ptrdiff_t{v} * view.camera.width + u);
        const bool is =
            !std::equal(with.begin() + pixel, with.begin() + pixel + 3, without.begin() + pixel);
        const Vector3d ray((u - view.camera.cx) / view.camera.fx,
                           (v - view.camera.cy) / view.camera.fy, 1);
        robot += is ? 1 : 0;
        wrong += is != own->hides(eye, view.world_from_optical * (5 * ray)) ? 1 : 0;
      }
    }
    EXPECT_GT(robot, 2000);
    EXPECT_LE(wrong, 0.003 * robot);  // rims
  }
}

TEST(OwnBody, OnlyShapesOfItsLinksBetweenEyeAndPlaceHide) {
  sim::Scene scene;
  scene.frames = {"world", "arm", "box::box"};
  sim::Visual visual;
  visual.shape = {sim::Shape::Kind::box, {0.1, 0.1, 0.1}, nullptr, ""};
  for (const int frame : {1, 2}) {
    visual.frame = frame;
    scene.visuals.push_back(visual);
  }
  sim::ScenePose pose;
  pose.frames.assign(3, Isometry3d::Identity());
  pose.frames[1].translation() = Vector3d(1, 0, 0);
  pose.frames[2].translation() = Vector3d(1, 1, 0);
  const std::vector<std::string> links{"arm"};
  OwnBody own = OwnBody::make(scene, links).value();
  own.move(pose, Isometry3d::Identity());
  EXPECT_TRUE(own.hides({0, 0, 0}, {2, 0, 0}));
  EXPECT_TRUE(own.hides({0, 0.06, 0}, {2, 0, 0}));
  EXPECT_FALSE(own.hides({0, 0, 0}, {0.9, 0, 0}));  // before it
  EXPECT_FALSE(own.hides({2, 0, 0}, {3, 0, 0}));    // behind it
  EXPECT_FALSE(own.hides({0, 0.06, 0}, {2, 0.06, 0}));
  EXPECT_FALSE(own.hides({0, 1, 0}, {2, 1, 0}));  // another's
  EXPECT_FALSE(own.hides({1, 0, 0}, {2, 0, 0}));  // of a shape around the eye pictures have nothing
  // Everything seen from a frame that is a metre aside.
  own.move(pose, Isometry3d(Eigen::Translation3d(0, 1, 0)));
  EXPECT_TRUE(own.hides({0, 1, 0}, {2, 1, 0}));
  EXPECT_FALSE(own.hides({0, 0, 0}, {2, 0, 0}));
}

}  // namespace
}  // namespace kaz::tools
