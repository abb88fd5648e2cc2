// The estimate of synthetic potentiometers, whose curves and whose robot are made by code of their own.
// SPDX-License-Identifier: Apache-2.0
#include "host/calibration/joint_estimator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host/calibration/joint_readings.h"

namespace kaz::calibration {
namespace {

constexpr double kTrack = 190 * kDegree;

// A potentiometer with its own mounting and with half waves on its element, read by a converter that rounds
// down.
struct Pot {
  double centre, sign, offset, waves[3];
  double code(double angle) const {
    const double x = 0.5 + sign * (angle + offset - centre) / kTrack;
    double out = x;
    for (int k = 0; k < 3; ++k) out += waves[k] * std::sin((k + 1) * std::numbers::pi * x);
    return 1024 * out - 0.5;
  }
};

class Robot {
 public:
  explicit Robot(unsigned seed) : random_(seed) {
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const auto line = nominal_calibration(j);
      // Without the half code of the converter, which the calibration of a board contains.
      const double half_code = 0.5 * line.scale_rad / 512;
      pots_.push_back({line.centre_rad - half_code,
                       line.scale_rad > 0 ? 1.0 : -1.0,
                       spread(0.5 * kDegree),
                       {spread(0.0014), spread(0.0007), spread(0.00035)}});
    }
  }
  double code(int joint, double angle) {
    return pots_[static_cast<std::size_t>(joint)].code(angle) + 0.05 * normal_(random_);
  }
  // Root mean square and largest error of a line over the joint's range.
  std::pair<double, double> errors(int joint, const host::JointCalibration& line) {
    const auto& info = host::joint_table()[static_cast<std::size_t>(joint)];
    double squares = 0, worst = 0;
    constexpr int n = 50;
    for (int i = 0; i <= n; ++i) {
      const double at = info.lower_rad + (info.upper_rad - info.lower_rad) * i / n;
      const double e = angle_at(line, pots_[static_cast<std::size_t>(joint)].code(at)) - at;
      squares += e * e / (n + 1);
      worst = std::max(worst, std::abs(e));
    }
    return {std::sqrt(squares), worst};
  }
  double noise(double sigma) { return sigma * normal_(random_); }

 private:
  double spread(double sigma) { return std::clamp(noise(sigma), -2 * sigma, 2 * sigma); }
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::vector<Pot> pots_;
};

void add_all_stops(JointEstimator& to, Robot& robot) {
  for (int j = 0; j < KZ_JOINTS; ++j)
    for (const Stop stop : {Stop::lower, Stop::upper})
      to.add_angle(j, robot.code(j, stop_angle(j, stop)), stop_angle(j, stop), kStopSigma);
}

// On a level floor, with an accelerometer that has a zero of its own. The direction of gravity in the trunk
// follows from the stance: last row of Ry(pitch) Rx(roll).
std::vector<FloorReading> stand(Robot& robot, double zero_g) {
  std::vector<FloorReading> readings;
  for (const motion::Stance& stance : floor_stances()) {
    const host::JointAngles angles = posture_of(stance);
    FloorReading reading;
    for (int j = 0; j < KZ_JOINTS; ++j)
      reading.codes[static_cast<std::size_t>(j)] =
          robot.code(j, angles[static_cast<std::size_t>(j)]);
    reading.has_force = true;
    reading.forward_m_per_s2 = 9.80665 * (zero_g - std::sin(stance.pitch));
    reading.left_m_per_s2 = 9.80665 * (std::cos(stance.pitch) * std::sin(stance.roll) - zero_g);
    reading.time_s = 2.5 * static_cast<double>(readings.size());
    readings.push_back(reading);
  }
  return readings;
}

TEST(JointEstimator, WithoutReadingsTheNominalLineRemains) {
  const auto solution = JointEstimator().solve();
  for (int j = 0; j < KZ_JOINTS; ++j) {
    const auto& joint = solution.joints[static_cast<std::size_t>(j)];
    EXPECT_NEAR(joint.line.centre_rad, nominal_calibration(j).centre_rad, 1e-9);
    EXPECT_NEAR(joint.line.scale_rad, nominal_calibration(j).scale_rad, 1e-9);
    EXPECT_GT(joint.expected_error_rad, 0.5 * kDegree);
    EXPECT_EQ(joint.equations, 0);
  }
}

TEST(JointEstimator, OffsetAndGainOfStraightPotentiometersFromTheirStops) {
  JointEstimator estimator;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    host::JointCalibration truth = nominal_calibration(j);
    truth.centre_rad += (j % 3 - 1) * 0.6 * kDegree;
    truth.scale_rad *= 1 + 0.001 * (j % 2);
    for (const Stop stop : {Stop::lower, Stop::upper})
      estimator.add_angle(j, code_at(truth, stop_angle(j, stop)), stop_angle(j, stop),
                          0.001 * kDegree);
  }
  const auto solution = estimator.solve();
  for (int j = 0; j < KZ_JOINTS; ++j) {
    const auto& line = solution.joints[static_cast<std::size_t>(j)].line;
    for (const double code : {150.0, 512.0, 850.0}) {
      host::JointCalibration truth = nominal_calibration(j);
      truth.centre_rad += (j % 3 - 1) * 0.6 * kDegree;
      truth.scale_rad *= 1 + 0.001 * (j % 2);
      EXPECT_NEAR(angle_at(line, code), angle_at(truth, code), 0.02 * kDegree) << j << " " << code;
    }
  }
}

TEST(JointEstimator, StopsLeaveLessThanHalfADegreeOfRandomPotentiometers) {
  std::vector<double> errors;
  double squares = 0, expected = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Robot robot(seed);
    JointEstimator estimator;
    add_all_stops(estimator, robot);
    const auto solution = estimator.solve();
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const auto& joint = solution.joints[static_cast<std::size_t>(j)];
      const double rms = robot.errors(j, joint.line).first;
      errors.push_back(rms);
      squares += rms * rms;
      expected += joint.expected_error_rad * joint.expected_error_rad;
      EXPECT_EQ(joint.equations, 2);
    }
  }
  std::ranges::sort(errors);
  const double p95 = errors[errors.size() * 95 / 100];
  std::printf("rms over the range, 95 %% of joints: %.3f deg; expected / true %.2f\n",
              p95 / kDegree, std::sqrt(expected / squares));
  EXPECT_LT(p95, 0.33 * kDegree);
  // What it expects of itself is what happens.
  EXPECT_NEAR(std::sqrt(expected / squares), 1, 0.2);
}

TEST(JointEstimator, TheFloorHalvesTheErrorOfTheLegsSumAndLeavesTheArms) {
  double before = 0, after = 0, arms_before = 0, arms_after = 0, sum_before = 0, sum_after = 0;
  double expected = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Robot robot(seed);
    JointEstimator stops;
    add_all_stops(stops, robot);
    const auto about = stops.solve();
    const auto standing = stand(robot, 0.12);
    JointEstimator all(floor_unknowns(standing));
    Robot again(seed);
    add_all_stops(all, again);
    add_floor(all, standing, about);
    const auto solution = all.solve();
    EXPECT_LT(solution.worst_residual, 3.5) << seed;
    EXPECT_NEAR(solution.unknowns[KZ_JOINTS * kPotTerms], 0.12, 0.01);
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const auto i = static_cast<std::size_t>(j);
      const double old_rms = robot.errors(j, about.joints[i].line).first;
      const double rms = robot.errors(j, solution.joints[i].line).first;
      (j < host::l_hip_roll ? arms_before : before) += old_rms * old_rms;
      (j < host::l_hip_roll ? arms_after : after) += rms * rms;
      if (j >= host::l_hip_roll)
        expected += solution.joints[i].expected_error_rad * solution.joints[i].expected_error_rad;
    }
    // The lean of the trunk in the crouch: sum of a leg's pitch joints.
    const host::JointAngles home = motion::home();
    for (const auto& [line_of, sum] :
         {std::pair{&about, &sum_before}, std::pair{&solution, &sum_after}}) {
      double error = 0;
      for (const int j : {host::l_hip_pitch, host::l_knee, host::l_ankle_pitch}) {
        const auto i = static_cast<std::size_t>(j);
        error += angle_at(line_of->joints[i].line, robot.code(j, home[i])) - home[i];
      }
      *sum += error * error;
    }
  }
  std::printf("legs: %.3f to %.3f deg rms, expected %.3f; lean in the crouch %.3f to %.3f\n",
              std::sqrt(before / 160) / kDegree, std::sqrt(after / 160) / kDegree,
              std::sqrt(expected / 160) / kDegree, std::sqrt(sum_before / 20) / kDegree,
              std::sqrt(sum_after / 20) / kDegree);
  EXPECT_LT(after, 0.8 * before);
  EXPECT_NEAR(arms_after / arms_before, 1, 1e-6);
}

TEST(JointEstimator, AGaugeInTheMiddleRemovesTheBow) {
  double before = 0, after = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Robot robot(seed);
    JointEstimator estimator;
    add_all_stops(estimator, robot);
    const auto stops = estimator.solve();
    estimator.add_angle(host::neck_pan, robot.code(host::neck_pan, 0), 0, 0.1 * kDegree);
    const auto gauged = estimator.solve();
    before = std::max(before, robot.errors(0, stops.joints[0].line).second);
    after = std::max(after, robot.errors(0, gauged.joints[0].line).second);
  }
  std::printf("neck_pan, worst angle of 40 robots: %.2f, with a gauge %.2f deg\n", before / kDegree,
              after / kDegree);
  EXPECT_LT(after, 0.5 * kDegree);
  EXPECT_LT(after, 0.8 * before);
}

// A sole that is not flat, or has slipped, shows.
TEST(JointEstimator, ContradictionsShow) {
  Robot robot(7);
  auto readings = stand(robot, 0);
  JointEstimator stops, all(floor_unknowns(readings));
  add_all_stops(stops, robot);
  add_all_stops(all, robot);
  readings[3].codes[host::l_ankle_pitch] += 12;  // 2 degrees
  add_floor(all, readings, stops.solve());
  const double residual = all.solve().worst_residual;
  std::printf("an ankle 2 deg off in one posture: %.1f sigma\n", residual);
  EXPECT_GT(residual, 7);
}

TEST(JointMotions, EachStopIsPressedOnceAndPosturesAreWithinTheLimits) {
  std::array<int, KZ_JOINTS> lower{}, upper{};
  for (const MotionGroup& group : stop_groups()) {
    for (const StopStep& step : group.steps) {
      for (const Press& press : step.presses)
        ++(press.stop == Stop::lower ? lower : upper)[static_cast<std::size_t>(press.joint)];
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        EXPECT_GE(step.posture[j], host::joint_table()[j].lower_rad) << group.name;
        EXPECT_LE(step.posture[j], host::joint_table()[j].upper_rad) << group.name;
      }
    }
  }
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    EXPECT_EQ(lower[j], 1) << host::joint_table()[j].name;
    EXPECT_EQ(upper[j], 1) << host::joint_table()[j].name;
  }
  for (const motion::Stance& stance : floor_stances()) {
    const auto angles = posture_of(stance);
    EXPECT_NEAR(motion::centre_over_feet(stance).x(), 0.01, 1e-4);
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      EXPECT_GE(angles[j], host::joint_table()[j].lower_rad + 2 * kDegree);
      EXPECT_LE(angles[j], host::joint_table()[j].upper_rad - 2 * kDegree);
    }
  }
}

}  // namespace
}  // namespace kaz::calibration
