// Short forms of the measurements of docs/results/README.md on the length of a step.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/studies/step_length/step_run.h"

namespace kaz::step_length {
namespace {

Course done(const Result<Course>& run) {
  if (run) return *run;
  ADD_FAILURE() << run.error().message;
  return {};
}

// Errors are of first order in the step, as the contacts are. At 4 ms the servo loop oscillates.
TEST(StepLength, ErrorsOfTheWalkingRobotGrowWithTheStepUntilTheServoOscillates) {
  Setting setting{.load = Load::walk, .step_ms = 0.125, .seconds = 5};
  const Course reference = done(run_smooth(setting));
  const auto at = [&](double step_ms) {
    setting.step_ms = step_ms;
    return deviation(done(run_smooth(setting)), reference);
  };
  const Deviation half = at(0.5), one = at(1), two = at(2), four = at(4);
  // Measured over 6 s: 0.08, 0.14, 0.24 mrad; 0.17, 0.34, 0.50 mm; 0.6, 1.0, 2.0 %. Twice that here,
  // still less than other errors (0.4 degrees of backlash are 7 mrad).
  EXPECT_LT(half.joints, 0.2e-3);
  EXPECT_LT(one.joints, 0.3e-3);
  EXPECT_LT(two.joints, 0.5e-3);
  EXPECT_LT(half.joints, one.joints);
  EXPECT_LT(one.joints, two.joints);
  EXPECT_LT(one.trunk, 0.7e-3);
  EXPECT_LT(two.trunk, 1e-3);
  EXPECT_LT(one.force, 0.02);
  EXPECT_LT(two.force, 0.04);
  EXPECT_LT(two.tracking, 1.02 * one.tracking);
  // Not inaccurate, but a different motion: the joints oscillate around their targets.
  EXPECT_GT(four.joints, 10 * two.joints);
}

// Distance of a ball that slides and then rolls: 0.5 m/s, 0.067 mm for each ms of the step.
TEST(StepLength, ErrorOfARollingBallIsProportional) {
  Setting setting{.load = Load::stand, .step_ms = 0.125, .seconds = 3};
  const Course reference = done(run_smooth(setting));
  for (const double step_ms : {0.5, 1.0, 2.0}) {
    setting.step_ms = step_ms;
    const double ball = deviation(done(run_smooth(setting)), reference).ball;
    EXPECT_GT(ball, 0.02e-3 * step_ms);
    EXPECT_LT(ball, 0.1e-3 * step_ms);
  }
}

// Through host, wire and firmware, motors with backlash: up to 2 ms it walks on the spot as it does at 1.
TEST(StepLength, TheWholeRobotWalksAtTwoMilliseconds) {
  Setting setting{.load = Load::walk, .step_ms = 1, .seconds = 5};
  const Course one = done(run(setting));
  setting.step_ms = 2;
  const Course two = done(run(setting));
  ASSERT_GT(one.at.size(), 2000u);
  EXPECT_LT(two.max_tilt, 0.35);  // it rolls by 16 degrees at each step
  const double tracking = deviation(one, one).tracking;
  EXPECT_LT(deviation(two, one).tracking, 1.15 * tracking);
}

}  // namespace
}  // namespace kaz::step_length
