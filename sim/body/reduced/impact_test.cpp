// Impacts with restitution against closed forms: heights, total energy, and impulses.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "sim/body/reduced/reduced_world.h"
#include "sim/body/world/plain_models_testing.h"

namespace kaz::sim {
namespace {

using Eigen::Vector3d;

constexpr double kImpactG = 9.81, kImpactDrop = 0.5,
                 kImpactHalf = 0.03;  // half: of the height at rest, m

RigidLink lying_capsule(const std::string& name, const Surface& surface) {
  constexpr double kMass = 0.05, kLength = 0.1;
  RigidLink link;
  link.name = name;
  link.mass = kMass;
  const double about = kMass * kImpactHalf * kImpactHalf / 2;
  const double across = about / 2 + kMass * kLength * kLength / 12;
  link.inertia = Vector3d(about, across, across).asDiagonal();
  CollisionShape shape = test::touching(Shape::Kind::capsule, {kImpactHalf, kLength, 0}, surface);
  shape.in_link.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()).toRotationMatrix();
  link.collisions.push_back(shape);
  return link;
}

RigidLink bouncer(const std::string& kind, const std::string& name, const Surface& surface) {
  if (kind == "sphere") return test::ball(name, 0.05, kImpactHalf, surface);
  if (kind == "box") return test::box(name, 0.05, {0.1, 0.08, 2 * kImpactHalf}, surface);
  return lying_capsule(name, surface);
}

// A column of `count` bodies, 1 mm apart, above a floor.
class Column {
 public:
  Column(const std::string& kind, int count, const Surface& surface, double tilt, double step_s)
      : step_s_(step_s), world_(world_of(kind, count, surface, tilt, step_s)) {
    for (int i = 0; i < count; ++i) links_.push_back(bouncer(kind, "", surface));
    before_ = poses();
  }
  void step() {
    in_flight_ = world_.find_contacts() == 0;
    before_ = poses();
    world_.step({}, 0);
    in_flight_ = in_flight_ && world_.find_contacts() == 0;
  }
  double height() const { return poses().front().translation().z() - kImpactHalf; }
  // Whether no contact acted in the last step.
  bool in_flight() const { return in_flight_; }
  // Energy in the middle of the last step, J; 0 on the floor.
  double energy() const {
    const std::vector<Eigen::Isometry3d> now = poses();
    double sum = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const Eigen::Isometry3d &a = before_[i], &b = now[i];
      const Vector3d velocity = (b.translation() - a.translation()) / step_s_;
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(a.linear().transpose() * b.linear()));
      const Vector3d spin = turn.angle() / step_s_ * turn.axis();  // body axes
      const double z = (a.translation().z() + b.translation().z()) / 2;
      sum += links_[i].mass * (velocity.squaredNorm() / 2 + kImpactG * (z - kImpactHalf)) +
             spin.dot(links_[i].inertia * spin) / 2;
    }
    return sum;
  }

 private:
  static ReducedWorld world_of(const std::string& kind, int count, const Surface& surface,
                               double tilt, double step_s) {
    Surface floor = surface;
    floor.restitution = 0;
    WorldModel around = test::floor_of(floor, {0, 0, -kImpactG});
    for (int i = 0; i < count; ++i) {
      const double z = kImpactDrop + kImpactHalf + i * (2 * kImpactHalf + 1e-3);
      around.bodies.push_back(
          test::thing(bouncer(kind, std::string("body") + std::to_string(i), surface), {0, 0, z}));
      around.bodies.back().pose.linear() =
          Eigen::AngleAxisd(tilt, Vector3d(0.6, 0.8, 0)).toRotationMatrix();
    }
    WorldOptions options;
    options.step_s = step_s;
    return {around, test::fixed_place(), test::free_motor(), options};
  }
  std::vector<Eigen::Isometry3d> poses() const {
    std::vector<Eigen::Isometry3d> all = world_.pose().frames;
    all.erase(all.begin(), all.end() - static_cast<std::ptrdiff_t>(links_.size()));
    return all;
  }

  double step_s_;
  std::vector<RigidLink> links_;
  ReducedWorld world_;
  std::vector<Eigen::Isometry3d> before_;
  bool in_flight_ = false;
};

Surface lively(double restitution, double mu) {
  return {.mu = mu, .restitution = restitution};
}

using Fall = std::tuple<const char*, double, double>;  // shape, restitution, step (s)

std::string fall_name(const testing::TestParamInfo<Fall>& test) {
  const auto& [kind, restitution, step_s] = test.param;
  return std::string(kind) + "_" + std::to_string(std::lround(100 * restitution)) + "_" +
         std::to_string(std::lround(1e6 * step_s)) + "us";
}

class Impact : public testing::TestWithParam<Fall> {};

// h_k = e^2k h_0. Peaks are seen at steps: up to g h^2 / 8 below the top.
TEST_P(Impact, RisesToTheSquareOfRestitution) {
  const auto& [kind, restitution, step_s] = GetParam();
  Column column(kind, 1, lively(restitution, 0.8), 0, step_s);
  double expected = kImpactDrop, low = 1, peak = 0, last = kImpactDrop;
  int peaks = 0;
  for (int i = 0; i < 8 / step_s && peaks < 10; ++i) {
    column.step();
    const double z = column.height();
    if (z < last) low = std::min(low, z);
    if (z < last && peak > 0.01) {
      expected *= restitution * restitution;
      ASSERT_NEAR(peak, expected, 1e-3 * expected + 2e-5) << "peak " << peaks + 1;
      ++peaks;
    }
    peak = z > last ? z : 0;
    last = z;
  }
  // Without restitution, a landing may end up to a step below the surface and is pushed out of it.
  if (restitution == 0) {
    EXPECT_LT(column.height(), 2e-3);
  }
  EXPECT_EQ(peaks, restitution == 1 ? 10 : restitution == 0.8 ? 8 : restitution == 0.5 ? 2 : 0);
  EXPECT_LT(low, 0.001);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Impact,
                         testing::Combine(testing::Values("sphere", "box", "capsule"),
                                          testing::Values(0.0, 0.5, 0.8, 1.0),
                                          testing::Values(0.25e-3, 1e-3, 4e-3)),
                         fall_name);

// Largest total energy in flight above the smallest one before it, as a share of that at the start.
double gained(Column& column, double step_s, double& left) {
  double smallest = INFINITY, gain = 0, start = 0;
  for (int i = 0; i < 4 / step_s; ++i) {
    column.step();
    if (!column.in_flight()) continue;
    left = column.energy();
    if (start == 0) start = left;
    gain = std::max(gain, (left - smallest) / start);
    smallest = std::min(smallest, left);
  }
  left /= start;
  return gain;
}

class TiltedImpact : public testing::TestWithParam<Fall> {};

// On its edge, Newton's law alone adds energy where friction turns the sliding velocity back.
TEST_P(TiltedImpact, NeverGainsEnergy) {
  const auto& [kind, restitution, step_s] = GetParam();
  for (const double mu : {0.2, 0.8, 2.0}) {
    for (const double tilt : {0.2, 0.5, 0.9, 1.3}) {
      Column column(kind, 1, lively(restitution, mu), tilt, step_s);
      double left = 0;
      EXPECT_LT(gained(column, step_s, left), 1e-3) << "mu " << mu << ", tilt " << tilt;
    }
  }
}

TEST_P(TiltedImpact, NeverGainsEnergyInAColumn) {
  const auto& [kind, restitution, step_s] = GetParam();
  for (const double tilt : {0.0, 0.4}) {
    Column column(kind, 3, lively(restitution, 0.8), tilt, step_s);
    double left = 0;
    EXPECT_LT(gained(column, step_s, left), 1e-3) << "tilt " << tilt;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, TiltedImpact,
                         testing::Combine(testing::Values("sphere", "box", "capsule"),
                                          testing::Values(0.5, 0.8, 1.0), testing::Values(1e-3)),
                         fall_name);

TEST(SingleImpact, KeepsAllEnergyWithoutFriction) {
  for (const char* kind : {"sphere", "box", "capsule"}) {
    for (const int count : {1, 3}) {
      Column column(kind, count, lively(1, 0), 0.4, 1e-3);
      double left = 0;
      gained(column, 1e-3, left);
      EXPECT_NEAR(left, 1, 0.002) << kind << ", " << count;
    }
  }
}

// The link's contact force, summed over time, is the change of momentum m (1 + e) v.
TEST(SingleImpact, IsPartOfTheContactForce) {
  constexpr double kMass = 0.2, kSpeed = 1.5, kBounce = 0.6;
  const RobotModel robot = test::lone(test::ball("ball", kMass, 0.02, lively(kBounce, 0.5)));
  WorldModel around = test::floor_of(Surface{}, Vector3d::Zero());
  around.robot_start.translation().z() = 0.02;
  ReducedWorld world(around, robot, test::free_motor(), {});
  ASSERT_TRUE(world.push("ball", {0, 0, -kMass * kSpeed}));
  world.watch_contacts(true);
  Vector3d sum = Vector3d::Zero(), watched = sum;
  for (int i = 0; i < 100; ++i) {
    world.step({}, 0);
    sum += world.link_forces()[0].force * world.step_s();
    for (const ContactPoint& point : world.contacts()) watched += point.force * world.step_s();
  }
  EXPECT_NEAR(world.tree().velocity[5], kBounce * kSpeed, 1e-5);
  EXPECT_NEAR(watched.z(), kMass * (1 + kBounce) * kSpeed, 1e-5);
  EXPECT_NEAR(sum.z(), kMass * (1 + kBounce) * kSpeed, 1e-5);
}

}  // namespace
}  // namespace kaz::sim
