// Plane segments in seeded scenes with noise, against the planes that the scenes are made of.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/plane_segments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

#include "shared/base/angle.hpp"
#include "vision/depth/stereo_testing.h"

namespace kaz::vision {
namespace {

bool long_run() {
  const char* value = std::getenv("KAZ_LONG");
  return value != nullptr && std::string(value) == "1";
}

struct Room {
  TestStereoScene scene;  // the floor, where there is one, is its first rectangle
  FrameInfo info;         // what the robot believes
  Eigen::Vector3d up;     // of the floor, optical frame
  double height_m = 0;    // of the lens above the floor
};

// Rectangles of a box that stands at x, y of the foot frame, its top `top` above the floor.
void add_box(Room& room, const Eigen::Isometry3d& eye_from_foot, double x, double y, double turn,
             const Eigen::Vector3d& size, double top) {
  const Eigen::Matrix3d m =
      (eye_from_foot.linear() * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ())).eval();
  const Eigen::Vector3d middle = eye_from_foot * Eigen::Vector3d(x, y, top - 0.5 * size.z());
  const Eigen::Vector3d a = m.col(0) * size.x(), b = m.col(1) * size.y(), c = m.col(2) * size.z();
  room.scene.add(middle + 0.5 * c, a, b);
  room.scene.add(middle - 0.5 * a, b, c);
  room.scene.add(middle - 0.5 * b, a, c);
  room.scene.add(middle + 0.5 * b, a, c);
}

// A robot that looks somewhere in a room: lens 0.22 to 0.32 m up, tilted 15 to 55 degrees down,
// rolled up to 6. Its posture errs by half a degree and 3 mm (sigma), as servos and springs allow.
// Scenes without visible floor under the feet: a step down or up, a ramp, a wall.
Room make_room(std::uint64_t seed, bool with_floor, int width = 320) {
  Random random(seed * 2654435761U + (with_floor ? 1 : 2));
  const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
  Room room;
  room.info = test_info(test_camera(width, width * 3 / 4));
  room.info.posture_known = true;
  room.height_m = between(0.22, 0.32);
  const double tilt = between(15 * kDegree, 55 * kDegree), roll = between(-0.1, 0.1);
  Eigen::Isometry3d foot_from_eye = Eigen::Isometry3d::Identity();
  foot_from_eye.translation() = Eigen::Vector3d(0.02, between(-0.05, 0.05), room.height_m);
  foot_from_eye.linear().col(0) = -Eigen::Vector3d::UnitY();
  foot_from_eye.linear().col(1) = -Eigen::Vector3d::UnitZ();
  foot_from_eye.linear().col(2) = Eigen::Vector3d::UnitX();
  foot_from_eye.rotate(Eigen::AngleAxisd(-tilt, Eigen::Vector3d::UnitX()));
  foot_from_eye.rotate(Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()));
  const Eigen::Isometry3d eye_from_foot = foot_from_eye.inverse();
  room.up = eye_from_foot.linear().col(2);
  Eigen::Isometry3d believed = foot_from_eye;
  for (int axis = 0; axis < 3; ++axis) {
    const auto channel = static_cast<std::uint64_t>(axis);
    believed.translation()[axis] += 0.003 * keyed_normal(seed, 1, channel);
    believed.rotate(Eigen::AngleAxisd(0.5 * kDegree * keyed_normal(seed, 2, channel),
                                      Eigen::Vector3d::Unit(axis)));
  }
  room.info.foot_from_eye = believed;

  const auto place = [&](const Eigen::Vector3d& middle, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& b) {
    room.scene.add(eye_from_foot * middle, eye_from_foot.linear() * a, eye_from_foot.linear() * b);
  };
  double ground = 0;
  if (with_floor) {
    place({0, 0, 0}, {8, 0, 0}, {0, 8, 0});
  } else {
    switch (seed % 4) {
      case 0:  // a step down of 5 to 12 cm
        ground = between(-0.12, -0.05);
        place({0, 0, ground}, {8, 0, 0}, {0, 8, 0});
        break;
      case 1:  // a table of 5 to 12 cm, all that is seen
        ground = between(0.05, 0.12);
        place({0, 0, ground}, {8, 0, 0}, {0, 8, 0});
        break;
      case 2: {  // a ramp of 12 to 30 degrees that begins at the feet
        const double slope = between(12 * kDegree, 30 * kDegree);
        const Eigen::Vector3d along(std::cos(slope), 0, std::sin(slope));
        place({-0.05, 0, 0}, 8 * along, {0, 8, 0});
        ground = 0.1;
        break;
      }
      default:  // nothing but a wall
        place({between(0.16, 0.25), 0, 0}, {0, 6, 0}, {0, 0, 6});
        ground = 0.1;
    }
  }
  if (random.chance(0.7)) {
    const double turn = between(-0.7, 0.7);
    place({between(0.9, 2.0), 0, 0.5}, {6 * std::sin(turn), 6 * std::cos(turn), 0}, {0, 0, 3});
  }
  for (auto boxes = random.below(11); boxes > 0; --boxes) {
    const double x = between(0.28, 1.2);
    Eigen::Vector3d size(between(0.03, 0.15), between(0.03, 0.15), between(0.03, 0.15));
    // On a lower ground a box's top may be level with the sole: that is a floor, though a small
    // one.
    if (!with_floor && std::abs(ground + size.z()) < 0.04) size.z() = 0.04 - ground;
    add_box(room, eye_from_foot, x, between(-0.8, 0.8) * x, between(-1.5, 1.5), size,
            ground + size.z());
  }
  return room;
}

// As stereo gives it: noise of 0.2 px, steps of 1/16 px, 5 % unknown, 1 % wrong.
void spoil(DepthImage& depth, std::uint64_t seed) {
  Random random(seed + 1000);
  for (std::size_t i = 0; i < depth.disparity_px.size(); ++i) {
    float& d = depth.disparity_px[i];
    if (d <= 0) continue;
    const double noisy = static_cast<double>(d) + 0.2 * keyed_normal(seed, 3, i);
    d = static_cast<float>(std::max(0.0, std::round(noisy * 16) / 16));
    const double chance = random.uniform();
    if (chance < 0.05) d = 0;
    if (chance > 0.99) d = static_cast<float>(60 * random.uniform());
  }
}

struct Outcome {
  int scenes = 0, found = 0, right = 0;  // right: all bounds held
  double worst_angle_deg = 0, worst_height_mm = 0, worst_overlap = 1;
};

// Overlap with the floor's pixels that have a depth at all.
double overlap(const PlaneSegments& planes, const std::vector<int>& patch,
               const DepthImage& depth) {
  int both = 0, either = 0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    if (depth.disparity_px[i] <= 0) continue;
    const int label = planes.label[i];
    const bool found = label > 0 && planes.segments[static_cast<std::size_t>(label - 1)].floor;
    both += found && patch[i] == 0 ? 1 : 0;
    either += found || patch[i] == 0 ? 1 : 0;
  }
  return either == 0 ? 1 : static_cast<double>(both) / either;
}

TEST(PlaneSegments, TheFloorIsFoundWhereThereIsOne) {
  const std::uint64_t scenes = long_run() ? 500 : 40;
  PlaneSegmentFinder finder;
  PlaneSegments planes;
  std::vector<int> patch;
  Outcome o;
  for (std::uint64_t seed = 1; o.scenes < static_cast<int>(scenes); ++seed) {
    const Room room = make_room(seed, true);
    DepthImage depth = room.scene.truth(room.info.camera, patch);
    // In view: at least a twentieth of the picture.
    if (std::count(patch.begin(), patch.end(), 0) * 20 < static_cast<long>(patch.size())) continue;
    depth.info = room.info;
    spoil(depth, seed);
    const auto ok = finder.find(depth, planes);
    ASSERT_TRUE(ok) << ok.error().message;
    ++o.scenes;
    const PlaneSegment* floor = nullptr;
    for (const PlaneSegment& s : planes.segments) {
      if (s.floor && (floor == nullptr || s.pixels > floor->pixels)) floor = &s;
    }
    if (floor == nullptr) {
      std::printf("scene %llu: no floor\n", static_cast<unsigned long long>(seed));
      continue;
    }
    ++o.found;
    const double angle = std::acos(std::min(1.0, floor->normal.dot(room.up))) / kDegree;
    const double height = 1000 * std::abs(floor->distance_m - room.height_m);
    const double iou = overlap(planes, patch, depth);
    o.worst_angle_deg = std::max(o.worst_angle_deg, angle);
    o.worst_height_mm = std::max(o.worst_height_mm, height);
    o.worst_overlap = std::min(o.worst_overlap, iou);
    if (angle < 2 && height < 5 && iou >= 0.9) {
      ++o.right;
    } else {
      std::printf("scene %llu: %.2f deg, %.1f mm, overlap %.3f\n",
                  static_cast<unsigned long long>(seed), angle, height, iou);
    }
  }
  std::printf(
      "%d scenes with a floor: found in %d, within all bounds in %d; worst normal %.2f deg, "
      "height %.1f mm, overlap %.3f\n",
      o.scenes, o.found, o.right, o.worst_angle_deg, o.worst_height_mm, o.worst_overlap);
  EXPECT_GE(o.right, 0.99 * o.scenes);
}

TEST(PlaneSegments, NoFloorIsReportedWhereThereIsNone) {
  const std::uint64_t scenes = long_run() ? 200 : 20;
  PlaneSegmentFinder finder;
  PlaneSegments planes;
  std::vector<int> patch;
  int reported = 0;
  std::size_t segments = 0;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    const Room room = make_room(seed, false);
    DepthImage depth = room.scene.truth(room.info.camera, patch);
    depth.info = room.info;
    spoil(depth, seed);
    ASSERT_TRUE(finder.find(depth, planes));
    segments += planes.segments.size();
    if (planes.floor_found()) {
      ++reported;
      std::printf("scene %llu: a floor where there is none\n",
                  static_cast<unsigned long long>(seed));
    }
  }
  std::printf("%llu scenes without floor: reported in %d; %zu segments\n",
              static_cast<unsigned long long>(scenes), reported, segments);
  EXPECT_EQ(reported, 0);
  EXPECT_GE(segments, scenes);  // it was not for lack of planes
}

// A floor, a wall, and a box's front and top.
TEST(PlaneSegments, SeveralPlanesAreFoundAtOnceWithTheirSizes) {
  for (const int width : {320, 640}) {
    const CameraModel camera = test_camera(width, width * 3 / 4);
    const TestStereoScene scene = test_corner();
    std::vector<int> patch;
    DepthImage depth = scene.truth(camera, patch);
    spoil(depth, 4);
    PlaneSegmentFinder finder;
    PlaneSegments planes;
    ASSERT_TRUE(finder.find(depth, planes));
    ASSERT_EQ(planes.label.size(), patch.size());
    for (int wanted = 0; wanted < 4; ++wanted) {
      const TestPatch& p = scene.patches[static_cast<std::size_t>(wanted)];
      const auto best = std::max_element(
          planes.segments.begin(), planes.segments.end(),
          [&](const PlaneSegment& a, const PlaneSegment& b) {
            const auto match = [&](const PlaneSegment& s) {
              return std::abs(s.normal.dot(p.normal())) -
                     10 * std::abs(s.distance_m - std::abs(p.normal().dot(p.corner)));
            };
            return match(a) < match(b);
          });
      ASSERT_NE(best, planes.segments.end());
      EXPECT_GT(std::abs(best->normal.dot(p.normal())), std::cos(2 * kDegree)) << wanted;
      EXPECT_NEAR(best->distance_m, std::abs(p.normal().dot(p.corner)), 0.005) << wanted;
      EXPECT_LT(best->normal.dot(best->middle), 0) << "not towards the eye";
      EXPECT_NEAR(best->normal.dot(best->middle), -best->distance_m, 1e-6);
      EXPECT_NEAR(best->error_px, 0.2, 0.05) << wanted;  // the noise that was put in
      EXPECT_FALSE(best->floor) << "nobody knows the posture";
      int both = 0, either = 0;
      const auto label = best - planes.segments.begin() + 1;
      for (std::size_t i = 0; i < patch.size(); ++i) {
        if (depth.disparity_px[i] <= 0) continue;
        const bool a = patch[i] == wanted, b = planes.label[i] == label;
        both += a && b ? 1 : 0;
        either += a || b ? 1 : 0;
      }
      // The box's top has 1550 pixels at 320 x 240: it is all edge.
      EXPECT_GT(both, (width == 640 || wanted < 2 ? 0.9 : 0.8) * either) << wanted;
      if (wanted == 2) {  // the front: 0.2 x 0.1 m
        // Up to one and a half squares of some 1/80 of the picture are missing on each side.
        const double square = 0.6 / camera.fx * width / 80;
        for (const double missing : {0.2 - best->length_m, 0.1 - best->width_m}) {
          EXPECT_GT(missing, 0);
          EXPECT_LT(missing, 3 * square);
        }
        EXPECT_GT(std::abs(best->along.x()), 0.98);
      }
    }
  }
}

TEST(PlaneSegments, SamePictureSameSeedSameSegments) {
  const Room room = make_room(7, true);
  std::vector<int> patch;
  DepthImage depth = room.scene.truth(room.info.camera, patch);
  depth.info = room.info;
  spoil(depth, 7);
  PlaneSegmentFinder one, two;
  PlaneSegments first, second, third;
  ASSERT_TRUE(one.find(depth, first));
  ASSERT_TRUE(one.find(depth, second));
  ASSERT_TRUE(two.find(depth, third));
  EXPECT_EQ(first.label, second.label);
  EXPECT_EQ(first.label, third.label);
  ASSERT_EQ(first.segments.size(), third.segments.size());
  for (std::size_t i = 0; i < first.segments.size(); ++i) {
    EXPECT_EQ(first.segments[i].normal, third.segments[i].normal);
    EXPECT_EQ(first.segments[i].distance_m, third.segments[i].distance_m);
  }
}

TEST(PlaneSegments, NothingAndNonsenseHaveNoPlanes) {
  PlaneSegmentFinder finder;
  PlaneSegments planes;
  DepthImage depth{test_info(test_camera()), 320, 240, std::vector<float>(320 * 240, 0.0F)};
  ASSERT_TRUE(finder.find(depth, planes));
  EXPECT_TRUE(planes.segments.empty());
  Random random(3);
  for (float& d : depth.disparity_px) d = static_cast<float>(64 * random.uniform());
  ASSERT_TRUE(finder.find(depth, planes));
  EXPECT_TRUE(planes.segments.empty());
  const float odd[] = {std::numeric_limits<float>::quiet_NaN(),
                       std::numeric_limits<float>::infinity(),
                       -5.0F,
                       1e30F,
                       1e-30F,
                       12.0F};
  for (float& d : depth.disparity_px) d = odd[random.below(6)];
  ASSERT_TRUE(finder.find(depth, planes));
  for (const PlaneSegment& s : planes.segments) EXPECT_TRUE(std::isfinite(s.distance_m));
}

TEST(PlaneSegments, WrongInputIsAnError) {
  PlaneSegments planes;
  const DepthImage good{test_info(test_camera()), 320, 240, std::vector<float>(320 * 240, 8.0F)};
  EXPECT_TRUE(PlaneSegmentFinder().find(good, planes));
  DepthImage wrong = good;
  wrong.disparity_px.resize(100);
  auto found = PlaneSegmentFinder().find(wrong, planes);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("must have one value per pixel"), std::string::npos);
  wrong = good;
  wrong.width = 8;
  EXPECT_FALSE(PlaneSegmentFinder().find(wrong, planes));
  wrong = good;
  wrong.info.camera.baseline_m = 0;
  found = PlaneSegmentFinder().find(wrong, planes);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("calibrate"), std::string::npos);
  EXPECT_FALSE(PlaneSegmentFinder({.max_planes = 17}).find(good, planes));
  EXPECT_FALSE(PlaneSegmentFinder({.triples = 0}).find(good, planes));
  EXPECT_FALSE(PlaneSegmentFinder({.tolerance_px = -1}).find(good, planes));
}

}  // namespace
}  // namespace kaz::vision
