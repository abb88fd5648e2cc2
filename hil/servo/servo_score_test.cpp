// Scores of logs whose errors are known.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_score.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/servo/truth_log_testing.h"

namespace kaz::hil {
namespace {

// The model predicts a resting arm at 0; the log reads `rad`.
ServoLog resting(const std::string& name, double rad) {
  ServoLog log = still_pendulum(2);
  log.name = name;
  log.motion = "rest";
  for (std::size_t i = 1; i < log.samples.size(); ++i) log.samples[i].position_rad = rad;
  return log;
}

ServoFit plain_fit() {
  ServoFit fit;
  fit.params.base = 1;
  return fit;
}

TEST(ServoScores, CompareErrorsWithRepeats) {
  const std::vector<ServoLog> logs = {resting("a", 0.001), resting("b", 0.002),
                                      resting("c", 0.003)};
  const ServoScore score = score_of(plain_fit(), logs);
  ASSERT_FALSE(score.groups.empty());
  EXPECT_EQ(score.groups[0].kind, "all");
  EXPECT_NEAR(score.groups[0].error_rad, 0.002, 1e-4);
  EXPECT_NEAR(score.groups[0].floor_rad, 0.002 / 3, 1e-4);
  EXPECT_TRUE(score.strays.empty());
  EXPECT_TRUE(score.gaps.empty()) << "2 mrad are below the limit of 10 mrad";
}

TEST(ServoScores, NameMotionAndPhaseOfAnIncompleteModel) {
  std::vector<ServoLog> logs = {resting("a", 0.03)};
  for (std::size_t i = 100; i < logs[0].samples.size(); ++i) {
    logs[0].samples[i].torque_on = false;
    logs[0].samples[i].position_rad = 0.05;
  }
  const ServoScore score = score_of(plain_fit(), logs);
  ASSERT_EQ(score.gaps.size(), 1u);
  EXPECT_EQ(score.gaps[0].motion, "rest");
  EXPECT_EQ(score.gaps[0].phase, "torque off");
  EXPECT_NEAR(score.gaps[0].phase_rad, 0.05, 1e-3);
  EXPECT_NEAR(score.gaps[0].limit_rad, 0.01, 1e-9);
  EXPECT_TRUE(std::isnan(score.groups[0].floor_rad)) << "no repeats";
}

TEST(ServoScores, ListLogsThatEndFarFromTheirRepeats) {
  const ServoScore score =
      score_of(plain_fit(), {resting("a", 0), resting("b", 0.001), resting("far", 0.4)});
  EXPECT_EQ(score.strays, std::vector<std::string>{"far"});
  EXPECT_GT(score.groups[0].error_rad, 0.1) << "the error is untrimmed";
  EXPECT_LT(score.groups[0].trimmed_rad, 0.002);
  EXPECT_TRUE(score_of(plain_fit(), {resting("a", 0), resting("far", 0.4)}).strays.empty());
}

TEST(ServoScores, RecognizeRepeatsByTheirSetting) {
  std::vector<ServoLog> logs(6, resting("a", 0));
  logs[1].gain_per_rad *= 2;
  logs[2].mass_kg += 0.1;
  logs[3].motion = "wave";
  for (ServoSample& one : logs[4].samples) one.goal_rad = 0.1;
  const auto groups = repeats_of(logs);
  ASSERT_EQ(groups.size(), 5u);
  EXPECT_EQ(groups[0], (std::vector<std::size_t>{0, 5}));
}

}  // namespace
}  // namespace kaz::hil
