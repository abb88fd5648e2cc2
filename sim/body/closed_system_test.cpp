// Free joints against school mechanics: a pendulum's period, the energy of a swinging chain.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <numbers>

#include "sim/body/test_files.h"
#include "sim/body/world.h"

namespace kaz::sim {
namespace {

constexpr double kG = 9.81;
constexpr double kStep = 1e-3;
constexpr double kRotor = 5e-4;  // kg m2, Kaz's; it turns with the joint and belongs to the answer

// Without friction, gap and heat. The bridge is open, so that back-EMF does nothing.
const char* const kFreeMotor = R"(<motors default="free"><motor name="free">
<stall_slope value="0.2288"/><friction value="0"/><back_emf value="0.1764"/>
<stiction_ratio value="1"/><rotor_inertia value="5e-4"/><max_supply value="12"/></motor></motors>)";

std::string number(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

// Rods of this mass, length between joints, centre of mass in the middle, inertia about it.
constexpr double kMass = 0.1, kLength = 0.2, kOwnInertia = 4e-4, kSlim = 2e-5;

// `count` of them below each other, hanging at zero from what does not move; every second joint turns
// about y, the others about x.
std::string chain(int count) {
  std::string text = "<robot name=\"chain\"><link name=\"world\"/>\n";
  std::string parent = "world";
  for (int i = 0; i < count; ++i) {
    const std::string name = "rod" + std::to_string(i);
    text += "<link name=\"" + name + "\"><inertial><origin xyz=\"0 0 " + number(-kLength / 2) +
            "\"/><mass value=\"" + number(kMass) + "\"/><inertia ixx=\"" + number(kOwnInertia) +
            "\" iyy=\"" + number(kOwnInertia) + "\" izz=\"" + number(kSlim) +
            "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n";
    text += "<joint name=\"j" + std::to_string(i) + "\" type=\"revolute\"><parent link=\"" +
            parent + "\"/><child link=\"" + name + "\"/><origin xyz=\"0 0 " +
            number(i ? -kLength : 0) + "\"/><axis xyz=\"" + (i % 2 ? "0 1 0" : "1 0 0") +
            "\"/><limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"10\"/></joint>\n";
    parent = name;
  }
  return text + "</robot>\n";
}

class ClosedSystem : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<World> load(int rods, const Eigen::Vector3d& gravity) {
    const std::string robot = folder_.write("chain.urdf", chain(rods));
    folder_.write("motor.xml", kFreeMotor);
    WorldOptions options;
    options.stepper = GetParam();
    options.step_s = kStep;
    const std::string pull =
        number(gravity.x()) + " " + number(gravity.y()) + " " + number(gravity.z());
    auto world = World::load(folder_.write("w.sdf", test::world_text(pull, "")), robot, options);
    EXPECT_TRUE(world) << world.error().message;
    return world ? std::move(*world) : nullptr;
  }
  test::Folder folder_;
};

INSTANTIATE_TEST_SUITE_P(Steppers, ClosedSystem, testing::Values("quick50", "exact", "reduced"));

// Gravity turned by the amplitude: the rod starts at rest so far from where it would hang.
//
// The scheme is semi-implicit and symmetric over a swing: its period errs by some (w h)^2, w being the
// frequency, 7.2 /s: 5e-5. The turning point, read once a step, is missed by less than (w h)^2 / 8.
TEST_P(ClosedSystem, PendulumHasThePeriodOfTheEllipticIntegral) {
  for (const double amplitude : {0.05, 0.5, 1.2}) {
    const auto world = load(1, {0, kG * std::sin(amplitude), -kG * std::cos(amplitude)});
    ASSERT_TRUE(world);
    const std::vector<MotorDrive> open(1);
    std::vector<double> crossings;  // of the lowest point
    double last = 0, furthest = 0;
    while (crossings.size() < 11 && world->time_s() < 30) {
      world->step(open, 10.0);
      const double angle = world->joints()[0].angle;
      if ((last < amplitude) != (angle < amplitude)) {
        const double share = (amplitude - last) / (angle - last);
        crossings.push_back(world->time_s() - kStep * (1 - share));
      }
      furthest = std::max(furthest, angle);
      last = angle;
    }
    ASSERT_EQ(crossings.size(), 11u);
    const double arm = kLength / 2, inertia = kOwnInertia + kMass * arm * arm + kRotor;
    const double rate = std::sqrt(kMass * kG * arm / inertia);
    const double expected = 4 / rate * std::comp_ellint_1(std::sin(amplitude / 2));
    const double period = (crossings[10] - crossings[0]) / 5;
    std::printf("%s, %.2f rad: period off by %+.1e, amplitude by %+.1e\n", GetParam(), amplitude,
                period / expected - 1, furthest / (2 * amplitude) - 1);
    EXPECT_NEAR(period, expected, 1e-4 * expected) << amplitude;
    EXPECT_NEAR(furthest - amplitude, amplitude, 5e-5 * amplitude);
  }
}

// Four rods, thrown sideways and turned in each other, no motor driven: after 20 s, some thirty swings,
// kinetic and potential energy (rotors included) are what they were.
//
// A step turns a rod by up to w h = 2 %, and the solver holds joints and axes where they were at its
// start: what is lost or made there is of second order, 4e-4 of the energy that moves, and need not
// cancel; ODE's correction of the joints puts some of it back. Solved exactly, 1e-3 must hold over the
// whole run; fifty iterations leave a tenth of a percent of each step's force besides, of either sign:
// 1e-2.
TEST_P(ClosedSystem, ChainKeepsItsEnergy) {
  constexpr std::size_t rods = 4;
  const Eigen::Vector3d gravity(kG * 0.5, kG * 0.6, -kG * std::sqrt(1 - 0.25 - 0.36));
  const auto world = load(rods, gravity);
  ASSERT_TRUE(world);
  const std::vector<MotorDrive> open(rods);
  const Eigen::Vector3d centre(0, 0, -kLength / 2);
  const Eigen::Matrix3d own = Eigen::Vector3d(kOwnInertia, kOwnInertia, kSlim).asDiagonal();
  using Poses = std::array<Eigen::Isometry3d, rods>;
  const auto poses = [&] {
    Poses now;
    for (std::size_t i = 0; i < rods; ++i) now[i] = world->link_pose("rod" + std::to_string(i));
    return now;
  };
  Poses before = poses();
  double start = 0, least = 0, most = 0, moves = 0, fastest = 0;
  for (const auto& pose : before) start -= kMass * gravity.dot(pose * centre);
  while (world->time_s() < 20) {
    world->step(open, 10.0);
    const Poses now = poses();
    // Speeds from the poses, so that they belong to the middle of the step, and so does the height.
    double kinetic = 0, potential = 0;
    for (std::size_t i = 0; i < rods; ++i) {
      const Eigen::Vector3d v = (now[i] * centre - before[i] * centre) / kStep;
      const Eigen::AngleAxisd turn(before[i].linear().transpose() * now[i].linear());
      const Eigen::Vector3d w = turn.axis() * turn.angle() / kStep;
      const double joint = world->joints()[i].velocity;
      kinetic += 0.5 * (kMass * v.squaredNorm() + w.dot(own * w) + kRotor * joint * joint);
      potential -= 0.5 * kMass * gravity.dot(now[i] * centre + before[i] * centre);
      fastest = std::max(fastest, w.norm());
    }
    before = now;
    moves = std::max(moves, kinetic);
    least = std::min(least, kinetic + potential - start);
    most = std::max(most, kinetic + potential - start);
  }
  std::printf("%s: %.3f J move, %.1f rad/s; of them %+.1e to %+.1e\n", GetParam(), moves, fastest,
              least / moves, most / moves);
  EXPECT_GT(moves, 0.4);
  EXPECT_LT(fastest * kStep, 0.02);
  const double share = std::string(GetParam()) == "quick50" ? 1e-2 : 1e-3;
  EXPECT_GT(least, -share * moves);
  EXPECT_LT(most, share * moves);
}

}  // namespace
}  // namespace kaz::sim
