// A ball in the hand stays there while the arm moves.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "tests/system/virtual_robot/robot_testing.h"

namespace kaz {
namespace {

// Centre of the grasp in the forearm's frame (docs/reference/robot.md).
const Eigen::Vector3d kGrasp(0, 0, -0.093);

double away_mm(const RobotFixture& fixture) {
  return 1e3 * (fixture.ball() - fixture.world().link_pose("r_elbow") * kGrasp).norm();
}

TEST(Grasp, HoldsTheBallWhileTheArmMoves) {
  // Lies between the jaws of the right hand, hanging: the lips carry it from the start.
  const auto fixture = RobotFixture::start(world_of(ball("0 -0.08 0.097", 0.015, 0.020, "")));
  ASSERT_TRUE(fixture);
  fixture->wait(0.2);
  EXPECT_LT(away_mm(*fixture), 6) << "it lies on the lips";
  fixture->move({{host::r_hand, 14 * kDegree}}, 0.8);
  fixture->wait(0.4);
  const double gripped = away_mm(*fixture);
  EXPECT_LT(gripped, 6);
  double worst = 0;
  const auto swing = [&](const std::vector<host::JointTarget>& targets, double seconds) {
    const auto set = fixture->robot().set_targets(targets, from_seconds(seconds));
    ASSERT_TRUE(set) << set.error().message;
    for (double t = 0; t < seconds + 0.3; t += 0.05) {
      fixture->wait(0.05);
      worst = std::max(worst, away_mm(*fixture));
    }
  };
  // Forward and up, elbow bent, out to the side, and as fast as the shoulder follows.
  const int rounds = long_run() ? 10 : 2;
  for (int i = 0; i < rounds; ++i) {
    swing({{host::r_sh_pitch, -90 * kDegree}, {host::r_elbow, -30 * kDegree}}, 0.8);
    swing({{host::r_sh_pitch, -30 * kDegree},
           {host::r_sh_roll, -50 * kDegree},
           {host::r_elbow, -90 * kDegree}},
          0.8);
    swing({{host::r_sh_pitch, 0}, {host::r_sh_roll, -10 * kDegree}, {host::r_elbow, 0}}, 0.6);
  }
  std::printf("ball from the centre of the grasp: %.2f mm gripped, at most %.2f mm\n", gripped,
              worst);
  // In the V it moves by what the jaw's weak loop yields; dropped it would be 90 mm away.
  EXPECT_LT(worst, 10);
  EXPECT_LT(fixture->tilt_deg(), 3);
  EXPECT_GT(fixture->ball().z(), 0.07);

  // And falls when the hand opens: nothing else holds it.
  fixture->move({{host::r_hand, -60 * kDegree}}, 0.5);
  fixture->wait(0.5);
  EXPECT_LT(fixture->ball().z(), 0.03);
}

}  // namespace
}  // namespace kaz
