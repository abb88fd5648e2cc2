// The parts of a ground that may be in shadow, against rays from the ground to the light.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/model/ground_shade.h"

#include <gtest/gtest.h>

#include "shared/base/random.hpp"
#include "sim/render/gl/shaders.h"
#include "sim/render/renderer_kind.h"
#include "sim/render/scenes_testing.h"

namespace kaz::sim {
namespace {

double unit(std::uint64_t a, std::uint64_t b) {
  return static_cast<double>(mix64(mix64(a) ^ b) >> 11) * 0x1p-53;
}

Piece sphere(double radius) {
  Piece piece;
  piece.casters = {{Eigen::Vector3d::Zero(), radius}};
  return piece;
}

bool inside(const std::vector<PictureRectangle>& parts, int u, int v) {
  int count = 0;
  for (const PictureRectangle& p : parts)
    count += u >= p.x && u < p.x + p.width && v >= p.y && v < p.y + p.height;
  EXPECT_LE(count, 1) << "parts overlap at " << u << " " << v;
  return count > 0;
}

// Spheres anywhere, also behind the lens and below the ground; tilted grounds and eyes.
TEST(GroundShade, EveryShadowIsInTheShadedPartsAndAllIsCoveredOnce) {
  const Eigen::Vector3d to_key = Light{}.to_key.normalized();
  long dark = 0, shaded = 0, samples = 0;
  for (std::uint64_t scene = 0; scene < 40; ++scene) {
    auto next = [&, k = std::uint64_t{0}](double low, double high) mutable {
      return low + (high - low) * unit(scene, k++);
    };
    std::vector<Piece> pieces;
    ScenePose pose;
    for (int i = 0; i < 4; ++i) {
      pieces.push_back(sphere(next(0.01, 0.1)));
      pieces.back().frame = i;
      Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
      frame.translation() = Eigen::Vector3d(next(-0.3, 1.2), next(-0.6, 0.6), next(-0.2, 0.5));
      pose.frames.push_back(frame);
    }
    View view;
    view.camera = camera_of_view(320, 240, kEyeView_rad);
    view.world_from_optical =
        look_at({0, next(-0.2, 0.2), next(0.1, 0.5)}, {1, next(-0.5, 0.5), next(-1.0, 0.3)});
    GroundPlane ground;
    ground.normal = Eigen::Vector3d(next(-0.2, 0.2), next(-0.2, 0.2), 1).normalized();
    ground.distance = next(-0.05, 0.05);
    const GroundParts parts = parts_of_ground(pieces, pose, view, ground, 0.0);
    for (int v = 0; v < 240; v += 3) {
      for (int u = 0; u < 320; u += 3) {
        const bool in_shaded = inside(parts.shaded, u, v);
        ASSERT_NE(in_shaded, inside(parts.lit, u, v)) << u << " " << v;
        ++samples;
        shaded += in_shaded;
        const Eigen::Vector3d ray = view.world_from_optical.linear() *
                                    Eigen::Vector3d((u - view.camera.cx) / view.camera.fx,
                                                    (v - view.camera.cy) / view.camera.fy, 1);
        const Eigen::Vector3d from = view.world_from_optical.translation();
        const double along = (ground.distance - ground.normal.dot(from)) / ground.normal.dot(ray);
        if (!(along > 0)) continue;  // sky
        const Eigen::Vector3d place = from + along * ray;
        bool blocked = false;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
          const Eigen::Vector3d to = pose.frames[i].translation() - place;
          const double nearest = to.dot(to_key);
          blocked |= nearest > 0 && (to - nearest * to_key).norm() < pieces[i].casters[0].radius;
        }
        dark += blocked;
        ASSERT_TRUE(!blocked || in_shaded) << "scene " << scene << ": " << u << " " << v;
      }
    }
  }
  EXPECT_GT(dark, samples / 50);       // there are shaded places in the reference
  EXPECT_LT(shaded, samples * 2 / 3);  // and not everything is shaded
}

TEST(GroundShade, TheTablesPictureIsTheSameWithTheMapLookedUpEverywhere) {
  for (const RendererKind kind : kRendererKinds) {
    SCOPED_TRACE(to_string(kind));
    TestScene s = table_scene();
    View view = eye_view(320);
    const auto renderer = std::move(*maker_of(kind)());
    ASSERT_TRUE(renderer->set_scene(s.scene));
    vision::Image parts;
    ASSERT_TRUE(renderer->render(s.pose, view, parts));
    // A second ground in the same frame, far below, makes both together not flat.
    Visual below = s.scene.visuals.front();
    below.name = "below";
    below.in_frame.translation().z() = -30;
    s.scene.visuals.push_back(below);
    const auto other = std::move(*maker_of(kind)());
    ASSERT_TRUE(other->set_scene(s.scene));
    vision::Image all;
    ASSERT_TRUE(other->render(s.pose, view, all));
    EXPECT_EQ(parts.rgb, all.rgb);
  }
}

}  // namespace
}  // namespace kaz::sim
