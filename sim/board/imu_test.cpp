// Gyro and accelerometer against the definitions of their parameters.
// SPDX-License-Identifier: Apache-2.0
#include "sim/board/imu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "shared/base/angle.hpp"

namespace kaz::sim {
namespace {

constexpr double kGravity = 9.80665;

SensorParams params() {
  return load_sensor_file("shared/robot/kaz/sensors.xml").value();
}
SensorParams quiet() {
  SensorParams f = params();
  f.gyro.noise_density = f.gyro.zero_offset = f.gyro.wander = 0;
  f.accelerometer.wander = 0;
  f.accelerometer.noise_density = f.accelerometer.zero_offset = 0;
  return f;
}

TEST(Imu, IdealGivesItsLawAtOnce) {
  Imu imu(params(), SensorSwitches::ideal(), 1);
  imu.advance(1, {});
  imu.advance(
      2, {.yaw_rate = 100 * kDegree, .forward_force = kGravity, .left_force = -0.5 * kGravity});
  EXPECT_NEAR(imu.ratio(0), 0.6, 1e-12);     // 0.5 V of 5 V more than 2.5 V
  EXPECT_NEAR(imu.ratio(1), 0.5624, 1e-12);  // 0.312 V
  EXPECT_NEAR(imu.ratio(2), 0.4688, 1e-12);
}

TEST(Imu, StandsAtTheEndsOfItsRanges) {
  Imu imu(quiet(), {}, 1);
  imu.advance(
      1, {.yaw_rate = 1000 * kDegree, .forward_force = 5 * kGravity, .left_force = -5 * kGravity});
  EXPECT_NEAR(imu.ratio(0), 0.8, 1e-12);
  EXPECT_NEAR(imu.ratio(1), 0.5 + 2 * 0.0624, 1e-12);
  EXPECT_NEAR(imu.ratio(2), 0.5 - 2 * 0.0624, 1e-12);
}

TEST(Imu, FollowsAStepAsAFirstOrderFilter) {
  Imu imu(quiet(), {}, 1);
  imu.advance(0, {});
  for (int t = 1; t <= 10; ++t) {
    imu.advance(t, {.yaw_rate = 1, .forward_force = 1});
    const double gyro = 1 - std::exp(-2 * std::numbers::pi * 40 * t * 1e-3);
    const double force = 1 - std::exp(-2 * std::numbers::pi * 50 * t * 1e-3);
    EXPECT_NEAR((imu.ratio(0) - 0.5) / params().gyro.share_per_unit, gyro, 1e-12);
    EXPECT_NEAR((imu.ratio(1) - 0.5) / params().accelerometer.share_per_unit, force, 1e-12);
  }
}

TEST(Imu, OffsetIsTheSeedsOwnAndWithinTheLimit) {
  double squares = 0;
  constexpr int count = 2000;
  for (int seed = 0; seed < count; ++seed) {
    SensorParams f = params();
    f.gyro.noise_density = f.gyro.wander = 0;
    Imu imu(f, {}, static_cast<std::uint64_t>(seed));
    imu.advance(1, {});
    const double offset = (imu.ratio(0) - 0.5) * 1000;  // degrees/s
    ASSERT_LE(std::abs(offset), 40 + 1e-9);
    squares += offset * offset;
  }
  // Half the limit as sigma, cut at two sigma: 0.9199 of the variance; five standard errors.
  EXPECT_NEAR(std::sqrt(squares / count), 20 * std::sqrt(0.9199), 1.5);
}

// Rate noise of the gyro at rest, degrees/s, sampled each millisecond.
std::vector<double> gyro_at_rest(int count) {
  SensorParams f = params();
  f.gyro.zero_offset = f.gyro.wander = 0;
  Imu imu(f, {}, 11);
  std::vector<double> rates;
  for (int t = 0; t < count; ++t) {
    imu.advance(t, {});
    rates.push_back((imu.ratio(0) - 0.5) * 1000);
  }
  return rates;
}

TEST(Imu, AllanDeviationIsThatOfTheNoiseDensity) {
  // IEEE 952: white rate noise of one-sided density N has the Allan deviation N / sqrt(2 tau), as
  // long as tau is long against the filter (4 ms).
  constexpr int samples = 1'000'000;
  const auto rates = gyro_at_rest(samples);
  for (const int length : {500, 1000, 2000}) {
    std::vector<double> means;
    for (int from = 0; from + length <= samples; from += length) {
      double sum = 0;
      for (int i = 0; i < length; ++i) sum += rates[static_cast<std::size_t>(from + i)];
      means.push_back(sum / length);
    }
    double squares = 0;
    for (std::size_t i = 1; i < means.size(); ++i) squares += std::pow(means[i] - means[i - 1], 2);
    const double allan = std::sqrt(squares / (2.0 * static_cast<double>(means.size() - 1)));
    const double tau = length * 1e-3;
    // 500 differences or more at 2 s: 4 % of one standard error; three of them.
    EXPECT_NEAR(allan / (0.1 / std::sqrt(2 * tau)), 1.0, 0.12) << tau;
  }
}

TEST(Imu, ZeroWandersAsAGaussMarkovProcess) {
  // In t it moves by sigma sqrt(2 (1 - exp(-t / time))), at any time; 300 parts know that to 4 %
  // of one standard error.
  constexpr int parts = 300, looked_s = 20;
  double moved = 0, where = 0;
  for (int part = 0; part < parts; ++part) {
    SensorParams f = quiet();
    f.gyro.wander = 0.5 * kDegree;
    f.gyro.wander_time_s = 100;
    Imu imu(f, {}, static_cast<std::uint64_t>(part));
    imu.advance(1, {});
    const double first = (imu.ratio(0) - 0.5) * 1000;
    for (int t = 2; t <= looked_s * 1000; ++t) imu.advance(t, {});
    const double last = (imu.ratio(0) - 0.5) * 1000;
    moved += (last - first) * (last - first);
    where += last * last;
  }
  EXPECT_NEAR(std::sqrt(where / parts) / 0.5, 1, 0.13);
  EXPECT_NEAR(std::sqrt(moved / parts) / (0.5 * std::sqrt(2 * (1 - std::exp(-0.2)))), 1, 0.13);
}

TEST(Imu, NoiseHasTheBandwidthOfTheFilter) {
  // A first-order filter passes pi/2 of its bandwidth: sigma = N sqrt(pi/2 f), in continuous time. Sampled
  // at 1 kHz it is N sqrt(500 a / (2 - a)), 3 % less at 40 Hz.
  const auto rates = gyro_at_rest(200'000);
  double squares = 0;
  for (const double rate : rates) squares += rate * rate;
  const double sigma = std::sqrt(squares / static_cast<double>(rates.size()));
  EXPECT_NEAR(sigma, 0.1 * std::sqrt(std::numbers::pi / 2 * 40), 0.05);
}

}  // namespace
}  // namespace kaz::sim
