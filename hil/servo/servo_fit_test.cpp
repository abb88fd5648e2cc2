// Fits by servos that are richer than the models.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "hil/servo/truth_log_testing.h"

namespace kaz::hil {
namespace {

using truth::Motion;

// ./tools/dev study servo-table does this for twenty, with every model.
TEST(ServoFits, PredictWhatTheyHaveNotSeenBetterWithLoad) {
  std::vector<ServoLog> logs, held_out;
  for (const Motion motion : {Motion::two_sines, Motion::lift_and_drop}) {
    logs.push_back(log_of(truth::swing(2, motion, 1, 1)));
    logs.push_back(log_of(truth::swing(2, motion, 0.5, 0.25)));
    held_out.push_back(log_of(truth::swing(2, motion, 1, 0.5)));
  }
  ServoFitOptions options;
  options.models = {1, 3, 5};
  const auto fits = fit_servo(logs, held_out, options);
  ASSERT_TRUE(fits) << fits.error().message;
  ASSERT_EQ(fits->size(), 3u);
  EXPECT_LT((*fits)[2].held_out.position_rad, 0.67 * (*fits)[0].held_out.position_rad);
  EXPECT_LT((*fits)[2].held_out.current_share, 0.15);
  std::set<std::string_view> open;
  for (const FittedServoParam& one : (*fits)[2].fitted) {
    if (!one.determined) open.insert(one.of->name);
  }
  EXPECT_FALSE(open.contains("kt"));
  EXPECT_FALSE(open.contains("resistance"));
  EXPECT_TRUE(open.contains("stribeck_power")) << "no servo of the truth has such a power";
}

// A log in which nothing moves says nothing of a rotor or of friction that slides.
TEST(ServoFits, SayWhatTheLogsDoNotDetermine) {
  ServoLog still = still_pendulum(3);
  still.has_current = true;
  for (ServoSample& one : still.samples) one.goal_rad = one.position_rad = 0.02;
  ServoFitOptions options;
  options.models = {1};
  const auto fits = fit_servo({still}, {}, options);
  ASSERT_TRUE(fits) << fits.error().message;
  for (const FittedServoParam& one : fits->front().fitted) {
    if (one.of->name == "armature" || one.of->name == "viscous") {
      EXPECT_FALSE(one.determined) << one.of->name;
    }
  }
  EXPECT_EQ(fits->front().held_out.position_rad, 0);
}

TEST(ServoFits, AreRefusedWithAReason) {
  EXPECT_FALSE(fit_servo({}, {}));
  // It rises by itself while the motor is off.
  ServoLog wrong = still_pendulum(3);
  for (ServoSample& one : wrong.samples) {
    one.torque_on = false;
    one.position_rad = 20 * one.time_s;
  }
  ServoFitOptions options;
  options.models = {1};
  const auto fits = fit_servo({wrong}, {}, options);
  ASSERT_FALSE(fits);
  EXPECT_NE(fits.error().message.find("no motor model fits these logs"), std::string::npos);
  options.stopped = [] { return true; };
  EXPECT_EQ(fit_servo({still_pendulum(2)}, {}, options).error().fault, Fault::interrupted);
}

}  // namespace
}  // namespace kaz::hil
