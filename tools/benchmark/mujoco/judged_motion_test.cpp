// Motion of each robot's heaviest link: Kaz's engine against MuJoCo and against closed forms.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "sim/body/description/convex_hull.h"
#include "sim/body/description/files_testing.h"
#include "sim/body/world/plain_models_testing.h"
#include "sim/body/world/staged_world.h"
#include "tools/benchmark/mujoco/mujoco_world.h"

namespace kaz::sim::bench {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Largest permitted difference during one second, as a fraction of the distance moved in that second.
constexpr double kAgrees = 0.01;
constexpr double kG = 9.81;           // m/s^2
constexpr double kStep = 1e-3;        // s, Kaz's default
constexpr double kMujocoStep = 1e-4;  // s
// Critically damped contacts would return 14 % of an impact's speed: three times that damping.
constexpr MujocoSettings kLanding{.solref = {4e-4, 3}};
// MuJoCo's cone model lifts a body that slides at v with the acceleration mu v damping. A body that hops
// takes a wrong path. Therefore the contacts have little damping and impedance, but hard friction.
constexpr MujocoSettings kSliding{.solref = {-1e6, -20}, .solimp = {0.1, 0.1}, .impratio = 1000};
constexpr double kDrop = 0.2;                      // m
constexpr double kSlide = 0.3;                     // m
constexpr double kRelease = std::numbers::pi / 3;  // rad

// The link in a frame that is turned by `turn`.
RigidLink turned_link(const RigidLink& link, const Matrix3d& turn) {
  RigidLink out;
  out.name = link.name;
  Isometry3d at = Isometry3d::Identity();
  at.linear() = turn;
  weld(out, link, at);
  out.visuals.clear();
  return out;
}

// Solid box with the link's mass and inertia.
CollisionShape inertia_box(const RigidLink& link) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(link.inertia);
  const Vector3d moments = principal.eigenvalues();
  const Vector3d square =
      6 / link.mass * (Vector3d::Constant(moments.sum()) - 2 * moments).cwiseMax(1e-9);
  CollisionShape box = test::touching(Shape::Kind::box, square.cwiseSqrt(), {});
  box.in_link.translation() = link.com;
  box.in_link.linear() = principal.eigenvectors();
  box.in_link.linear().col(2) = box.in_link.linear().col(0).cross(box.in_link.linear().col(1));
  return box;
}

// The heaviest link of a file. A link without collision shapes gets its inertia box.
RigidLink heaviest_link(const std::string& path) {
  const auto robot = load_robot(path, {.skip_missing_meshes = true});
  if (!robot) {
    ADD_FAILURE() << full_text(robot.error());
    return test::ball("ball", 1, 0.1, {});
  }
  const auto heavier = [](const RobotLink& a, const RobotLink& b) {
    return a.rigid.mass < b.rigid.mass;
  };
  RigidLink link = std::ranges::max_element(robot->links, heavier)->rigid;
  link.name = "judged";
  if (link.collisions.empty()) link.collisions.push_back(inertia_box(link));
  return link;
}

// The world for MuJoCo: each hull is replaced by balls at its vertices. These are exact on a plane, where
// MuJoCo takes only four vertices of a mesh, and none that are near each other.
WorldModel with_points(WorldModel world) {
  for (WorldBody& body : world.bodies) {
    std::vector<CollisionShape> parts;
    for (const CollisionShape& part : body.rigid.collisions) {
      if (!part.shape.hull) parts.push_back(part);
      for (std::size_t i = 0; part.shape.hull && i < part.shape.hull->size(); ++i) {
        parts.push_back(test::touching(Shape::Kind::sphere, {1e-6, 0, 0}, part.surface));
        parts.back().in_link.translation() = part.in_link * part.shape.hull->point(i);
      }
    }
    body.rigid.collisions = parts;
  }
  return world;
}

// Points on a shape whose hull is the shape, or a polyhedron within 0.5 % of it.
std::vector<Vector3d> surface_points(const Shape& shape) {
  std::vector<Vector3d> points;
  if (shape.hull) {
    for (std::size_t i = 0; i < shape.hull->size(); ++i) points.push_back(shape.hull->point(i));
    return points;
  }
  constexpr int kSides = 32;
  const bool box = shape.kind == Shape::Kind::box, sphere = shape.kind == Shape::Kind::sphere;
  const double half = box ? shape.size.z() / 2 : sphere ? 0 : shape.size.y() / 2;
  for (const double z : {-half, half}) {
    for (int i = 0; i < (box ? 4 : kSides); ++i) {
      const double angle = 2 * std::numbers::pi * i / kSides;
      points.push_back(
          box ? Vector3d((i & 1 ? 1 : -1) * shape.size.x() / 2,
                         (i & 2 ? 1 : -1) * shape.size.y() / 2, z)
              : Vector3d(shape.size.x() * std::cos(angle), shape.size.x() * std::sin(angle), z));
    }
  }
  return points;
}

// Face on which the link stands most safely.
struct Stand {
  Vector3d outward = -Vector3d::UnitZ();
  // Distance of the center of mass from the nearest edge of the face, along the face, over its height. A
  // block tips if the friction coefficient exceeds this value.
  double stability = 0;
};
Stand safest_stand(const RigidLink& link) {
  std::vector<Vector3d> points;
  for (const CollisionShape& part : link.collisions)
    for (const Vector3d& point : surface_points(part.shape)) points.push_back(part.in_link * point);
  const auto hull = convex_hull(points);
  Stand best;
  for (std::size_t face = 0; hull && face < hull->planes.size() / 4; ++face) {
    const Vector3d normal = Eigen::Map<const Vector3d>(hull->planes.data() + 4 * face);
    const double offset = hull->planes[4 * face + 3];
    const Vector3d side = normal.unitOrthogonal(), other = normal.cross(side);
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 90; ++i) {
      const double angle = 2 * std::numbers::pi * i / 90;
      const Vector3d along = std::cos(angle) * side + std::sin(angle) * other;
      double edge = -nearest;
      for (const Vector3d& point : points) {
        if (normal.dot(point) > offset - 1e-5) edge = std::max(edge, along.dot(point - link.com));
      }
      nearest = std::min(nearest, edge);
    }
    const double stability = nearest / (offset - normal.dot(link.com));
    if (stability > best.stability) best = {normal, stability};
  }
  return best;
}

// Centers of mass and three points at the radius of gyration move by this much.
std::vector<Vector3d> watched_points(const RigidLink& link) {
  const double radius = std::sqrt(link.inertia.trace() / 2 / link.mass);
  std::vector<Vector3d> points(4, link.com);
  for (int k = 0; k < 3; ++k) points[static_cast<std::size_t>(k) + 1][k] += radius;
  return points;
}

using Path = std::vector<Isometry3d>;  // poses of the link at each millisecond of one second

// Start of a motion: pushes on links of the robot (N s), and the velocity of the object `judged` (m/s).
struct Start {
  std::vector<std::pair<std::string, Vector3d>> pushes;
  Vector3d velocity = Vector3d::Zero();
};

// Moves the world by one second. MuJoCo's poses are those of the start of its last step.
Path moved(World& world, const std::string& link, const Start& start) {
  for (const auto& [pushed, impulse] : start.pushes) EXPECT_TRUE(world.push(pushed, impulse));
  const auto& frames = world.scene().frames;
  const auto frame = static_cast<std::size_t>(std::ranges::find(frames, link) - frames.begin());
  EXPECT_LT(frame, frames.size());
  if (!start.velocity.isZero()) {
    EXPECT_TRUE(world.accelerate(link, start.velocity));
  }
  const std::vector<MotorDrive> open(world.joints().size());
  if (world.step_s() < kStep) world.step(open, 10);
  const auto steps = std::lround(kStep / world.step_s());
  Path path;
  for (int sample = 0; sample < 1000; ++sample) {
    for (long i = 0; i < steps; ++i) world.step(open, 10);
    path.push_back(world.pose().frames[frame]);
  }
  EXPECT_EQ(world.diagnostics().summary(), "");
  return path;
}

struct Judged {
  Path ours, theirs;
  double distance = 0;  // m, path of the point that moves farthest, in MuJoCo
  double off = 0;       // m, largest difference of a point
};

class JudgedMotion : public testing::TestWithParam<std::string> {
 protected:
  // Moves the robot's link `judged` in both engines.
  static Judged judge(const WorldModel& around, const RobotModel& robot, const RigidLink& judged,
                      const MujocoSettings& mujoco = {}, const Start& start = {}) {
    MotorParams motor = test::free_motor();
    motor.rotor_inertia_kgm2 = 1e-6;
    auto ours = make_world(around, robot, motor, {.step_s = kStep, .dynamics = "reduced"});
    auto theirs =
        MujocoWorld::make(with_points(around), robot, motor, {.step_s = kMujocoStep}, mujoco);
    Judged result;
    if (!ours || !theirs) {
      ADD_FAILURE() << (ours ? theirs.error() : ours.error()).message;
      return result;
    }
    result.ours = moved(**ours, judged.name, start);
    result.theirs = moved(**theirs, judged.name, start);
    for (const Vector3d& point : watched_points(judged)) {
      double distance = 0;
      for (std::size_t i = 0; i < result.ours.size(); ++i) {
        const Vector3d there = result.theirs[i] * point;
        if (i > 0) distance += (there - result.theirs[i - 1] * point).norm();
        result.off = std::max(result.off, (there - result.ours[i] * point).norm());
      }
      result.distance = std::max(result.distance, distance);
    }
    std::printf("%s: moves %.3f m, off by %.3f mm, %.2f %%\n", judged.name.c_str(), result.distance,
                1e3 * result.off, 100 * result.off / result.distance);
    EXPECT_LT(result.off, kAgrees * result.distance);
    return result;
  }

  // Largest difference of the center of mass from `expected` at the time t (s), m.
  template <class F>
  static double off_from(const Path& path, const Vector3d& com, double until_s, const F& expected) {
    double off = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const double t = static_cast<double>(i + 1) * kStep;
      if (t <= until_s) off = std::max(off, (path[i] * com - expected(t)).norm());
    }
    return off;
  }

  // The heaviest link on its safest face, with this friction coefficient.
  RigidLink standing_link(double mu) const {
    const Quaterniond down = Quaterniond::FromTwoVectors(stand_.outward, -Vector3d::UnitZ());
    RigidLink link = turned_link(link_, down.toRotationMatrix());
    for (CollisionShape& part : link.collisions) part.surface = {.mu = mu};
    return link;
  }
  // Position of the center of mass while the link stands at the origin.
  static Vector3d standing_com(const RigidLink& link) {
    return link.com - Vector3d(0, 0, test::lone(link).extent().min().z());
  }

  const RigidLink link_ = heaviest_link(GetParam());
  const Stand stand_ = safest_stand(link_);
};

TEST_P(JudgedMotion, FallsAndLands) {
  ASSERT_GT(stand_.stability, 0) << "the link has no face to stand on";
  const RigidLink link = standing_link(0.5);
  WorldModel around = test::floor_of({.mu = 0.5}, {0, 0, -kG});
  around.bodies.push_back(
      test::thing(link, standing_com(link) - link.com + kDrop * Vector3d::UnitZ()));
  const Judged fall = judge(around, test::fixed_place(), link, kLanding);
  const Vector3d rest = standing_com(link);
  const double lands_s = std::sqrt(2 * kDrop / kG);
  const auto expected = [&](double t) -> Vector3d {
    return rest + Vector3d(0, 0, t < lands_s ? kDrop - kG * t * t / 2 : 0);
  };
  EXPECT_LT(off_from(fall.ours, link.com, 1, expected), kAgrees * kDrop);
}

// A floor that is the top of a box.
WorldBody table_of(const Surface& surface) {
  WorldBody table = test::thing(test::box("table", 1, {2, 2, 0.2}, surface), {0, 0, -0.1});
  table.fixed = true;
  return table;
}

TEST_P(JudgedMotion, Slides) {
  ASSERT_GT(stand_.stability, 0) << "the link has no face to stand on";
  const double mu = std::min(0.1, stand_.stability / 2);
  const RigidLink link = standing_link(mu);
  const double speed = std::sqrt(2 * mu * kG * kSlide);
  const auto expected = [&](double t) -> Vector3d {
    const double left = std::max(0.0, speed - mu * kG * t);
    return standing_com(link) + Vector3d((speed * speed - left * left) / (2 * mu * kG), 0, 0);
  };
  const double end = std::min(1.0, speed / (mu * kG));
  const double bound = kAgrees * (expected(end) - standing_com(link)).norm();
  const Start start{.pushes = {}, .velocity = speed * Vector3d::UnitX()};
  WorldModel around = test::floor_of({.mu = mu}, {0, 0, -kG});
  around.bodies.push_back(test::thing(link, standing_com(link) - link.com));
  const Judged slide = judge(around, test::fixed_place(), link, kSliding, start);
  EXPECT_LT(off_from(slide.ours, link.com, 1, expected), bound);
  around.bodies[0] = table_of({.mu = mu});
  const auto on_table = make_world(around, test::fixed_place(), test::free_motor(), {});
  ASSERT_TRUE(on_table);
  EXPECT_LT(off_from(moved(**on_table, link.name, start), link.com, 1, expected), bound)
      << "on a table";
}

// An axis through the frame's origin, or 5 cm beside the center of mass if that is near the origin.
TEST_P(JudgedMotion, SwingsAsAPendulum) {
  Vector3d arm = link_.com;
  if (arm.norm() < 0.01) arm = {0.05, 0, 0};
  const Vector3d axis = arm.unitOrthogonal();
  Matrix3d from, to;
  from << axis, arm.normalized(), axis.cross(arm.normalized());
  const Vector3d down(0, std::sin(kRelease), -std::cos(kRelease));
  to << Vector3d::UnitX(), down, Vector3d::UnitX().cross(down);
  RigidLink link = turned_link(link_, to * from.transpose());
  link.collisions.clear();
  link.com = arm.norm() * down;
  RobotModel robot = test::fixed_place();
  test::add_link(robot, link, Vector3d::Zero(), Vector3d::UnitX(), -1e3, 1e3);
  WorldModel around;
  around.gravity = {0, 0, -kG};
  const Judged swing = judge(around, robot, link);

  // th'' = -(m g d / I) sin th by classical fourth-order Runge-Kutta in steps of 1 ms: error below 1e-9 rad.
  const double inertia = link.inertia(0, 0) + link.mass * arm.squaredNorm() + 1e-6;
  const auto faster = [&](double angle) {
    return -link.mass * kG * arm.norm() / inertia * std::sin(angle);
  };
  double angle = kRelease, rate = 0, off = 0;
  for (const Isometry3d& pose : swing.ours) {
    const double h = kStep, a1 = faster(angle), r2 = rate + h / 2 * a1;
    const double a2 = faster(angle + h / 2 * rate), r3 = rate + h / 2 * a2;
    const double a3 = faster(angle + h / 2 * r2), r4 = rate + h * a3;
    const double a4 = faster(angle + h * r3);
    angle += h / 6 * (rate + 2 * r2 + 2 * r3 + r4);
    rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    const Vector3d expected = arm.norm() * Vector3d(0, std::sin(angle), -std::cos(angle));
    off = std::max(off, (pose * link.com - expected).norm());
  }
  EXPECT_LT(off, kAgrees * swing.distance);
}

// A handle at the radius of gyration takes one of two opposite pushes. Both engines have the same handle.
TEST_P(JudgedMotion, SpinsInFreeFlight) {
  const double radius = std::sqrt(link_.inertia.trace() / 2 / link_.mass);
  RigidLink bare = turned_link(link_, Matrix3d::Identity());
  bare.collisions.clear();
  RigidLink handle = test::ball("handle", 0.05 * link_.mass, 0.1 * radius, {});
  handle.collisions.clear();
  RobotModel robot = test::lone(bare);
  test::add_link(robot, handle, bare.com + radius * Vector3d(0.6, 0.5, 0.6), Vector3d::UnitX(),
                 -1e3, 1e3);
  WorldModel around;
  around.gravity.setZero();
  const Vector3d push = bare.mass * radius * Vector3d(4, -3, 2);
  const Judged flight =
      judge(around, robot, bare, {},
            {.pushes = {{"handle", push}, {bare.name, -push}}, .velocity = Vector3d::Zero()});
  EXPECT_GT(flight.distance, 2 * radius) << "the link must really turn";
}

INSTANTIATE_TEST_SUITE_P(Files, JudgedMotion, testing::ValuesIn(test::robot_files()),
                         test::robot_test_name);

}  // namespace
}  // namespace kaz::sim::bench
