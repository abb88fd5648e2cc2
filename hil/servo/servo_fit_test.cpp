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

// Delay, slew limit, lag, coasting friction and zeros that the generator has.
TEST(ServoFits, FindThePlantedEffects) {
  truth::Planted planted{0.0234, 4.9, 0.007, 0.08, 0.05, true};
  std::vector<ServoLog> logs;
  for (const Motion motion :
       {Motion::two_sines, Motion::lift_and_drop, Motion::steps, Motion::sine_of_square}) {
    for (const double gain : {1.0, 0.5, 0.25}) {
      planted.zero = 0.05;
      logs.push_back(log_of(truth::swing(3, motion, 1, gain, 6, planted)));
      planted.zero = -0.03;
      logs.push_back(log_of(truth::swing(3, motion, 0.5, gain, 6, planted)));
    }
  }
  ServoFitOptions options;
  options.models = {1, 3};
  const auto fits = fit_servo(logs, {}, options);
  ASSERT_TRUE(fits) << fits.error().message;
  const ServoFit& fit = fits->back();
  EXPECT_NEAR(fit.params.delay, 0.0234, 0.05 * 0.0234);
  EXPECT_NEAR(fit.params.slew, 4.9, 0.05 * 4.9);
  EXPECT_NEAR(fit.params.lag, 0.007, 0.05 * 0.007);
  EXPECT_NEAR(fit.params.coasting, 0.08, 0.05 * 0.08);
  ASSERT_EQ(fit.zeros.size(), 2u);
  EXPECT_NEAR(fit.zeros[0].zero_rad, 0.05, 0.05 * 0.05);
  EXPECT_NEAR(fit.zeros[1].zero_rad, -0.03, 0.05 * 0.05);
  EXPECT_LT(fit.fit.position_rad, 3e-3);
}

TEST(ServoFits, DoNotDependOnTheNumberOfThreads) {
  std::vector<ServoLog> logs;
  for (const Motion motion : {Motion::two_sines, Motion::lift_and_drop, Motion::steps})
    logs.push_back(log_of(truth::swing(2, motion, 1, 1, 2)));
  ServoFitOptions options;
  options.models = {1};
  options.threads = 1;
  const auto one = fit_servo(logs, {}, options);
  options.threads = 3;
  const auto three = fit_servo(logs, {}, options);
  ASSERT_TRUE(one && three);
  for (std::size_t i = 0; i < one->front().fitted.size(); ++i)
    EXPECT_EQ(one->front().fitted[i].value, three->front().fitted[i].value);
}

// A prediction must not use the logs that judge it, so a held-out rig has the mean zero of the others.
TEST(ServoFits, PredictAHeldOutRigWithTheMeanZero) {
  truth::Planted planted{0, 1e9, 0, 0, 0.02, true};
  std::vector<ServoLog> logs, held_out;
  for (const Motion motion : {Motion::two_sines, Motion::lift_and_drop, Motion::up_and_down}) {
    planted.zero = 0.02;
    logs.push_back(log_of(truth::swing(3, motion, 1, 1, 4, planted)));
    logs.push_back(log_of(truth::swing(3, motion, 1, 0.4, 4, planted)));
    planted.zero = -0.04;
    held_out.push_back(log_of(truth::swing(3, motion, 0.7, 1, 4, planted)));
  }
  ServoFitOptions options;
  options.models = {1, 3};
  const auto fits = fit_servo(logs, held_out, options), alone = fit_servo(logs, {}, options);
  ASSERT_TRUE(fits && alone);
  const ServoFit& fit = fits->back();
  ASSERT_EQ(fit.zeros.size(), 2u);
  EXPECT_FALSE(fit.zeros[0].held_out);
  EXPECT_TRUE(fit.zeros[1].held_out);
  EXPECT_EQ(fit.zeros[1].rig, held_out[0].rig());
  EXPECT_EQ(fit.zeros[1].zero_rad, fit.zeros[0].zero_rad);
  ASSERT_EQ(fit.own_zeros.size(), 1u);
  EXPECT_NEAR(fit.own_zeros[0].zero_rad, -0.04, 0.005);
  EXPECT_EQ(fit.with_own_zeros().zero_of(held_out[0]), fit.own_zeros[0].zero_rad);
  EXPECT_LT(fit.held_out_own_zeros.position_rad, 0.7 * fit.held_out.position_rad);
  EXPECT_EQ(fit.params.kt, alone->back().params.kt);
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

TEST(ServoFits, LeaveTheMiddleGainAndMassOutForTheChoice) {
  std::vector<ServoLog> logs(4, still_pendulum(2));
  for (std::size_t i = 0; i < 4; ++i) logs[i].motion = i < 2 ? "a" : "b";
  auto splits = inner_splits(logs);
  ASSERT_EQ(splits.size(), 1u);
  EXPECT_EQ(splits[0].name, "motion b");
  logs[1].gain_per_rad = 5;
  logs[2].gain_per_rad = 6;
  logs[3].mass_kg = 0.2;
  splits = inner_splits(logs);
  ASSERT_EQ(splits.size(), 2u);
  EXPECT_EQ(splits[0].name, "gain 5 per rad");
  EXPECT_EQ(splits[0].left_out, std::vector<const ServoLog*>{&logs[1]});
  EXPECT_EQ(splits[1].name, "mass 0.4 kg") << "the larger of two";
  EXPECT_EQ(splits[1].fitted, std::vector<const ServoLog*>{&logs[3]});
  EXPECT_TRUE(inner_splits({logs[0]}).empty());
}

TEST(ServoFits, AreChosenWithoutTheHeldOutLogs) {
  std::vector<ServoFit> fits(3);
  for (int i = 0; i < 3; ++i) fits[static_cast<std::size_t>(i)].model = i + 1;
  fits[0].held_out.position_rad = 1e-3;
  fits[0].fit.position_rad = 0.01;
  fits[1].fit.position_rad = 0.0051;
  fits[2].fit.position_rad = 0.005;
  EXPECT_EQ(chosen_fit(fits).model, 2) << "within 3 % of the smallest";
  fits[0].inner_rad = 0.02;
  fits[1].inner_rad = 0.012;
  fits[2].inner_rad = 0.01;
  EXPECT_EQ(chosen_fit(fits).model, 3);
}

// A weight that the servo lifts with 80 % and with 100 % duty to the same angle.
TEST(ServoFits, FindACurrentLimit) {
  ServoFit truth;
  truth.params.kt = 1.6;
  truth.params.most_current = 0.8;
  std::vector<ServoLog> logs;
  for (const double gain : {1.0, 0.5, 0.25})
    for (const Motion motion : {Motion::two_sines, Motion::up_and_down})
      logs.push_back(log_of(truth::swing(3, motion, 1, gain, 4)));
  for (ServoLog& log : logs) {
    const Prediction made = truth.predict(log);
    for (std::size_t i = 0; i < log.samples.size(); ++i) {
      log.samples[i].position_rad = made.position_rad[i];
      log.samples[i].current_a = made.current_a[i];
    }
  }
  ServoFitOptions options;
  options.models = {1};
  const auto fits = fit_servo(logs, {}, options);
  ASSERT_TRUE(fits) << fits.error().message;
  EXPECT_NEAR(fits->back().params.most_current, 0.8, 0.02);
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
