// The balance policy: alike for left and right, without effect where it corrects nothing, within its limits.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/balance.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "host/motion/motion.h"
#include "shared/base/random.hpp"

namespace kaz::motion {
namespace {

using Weights = std::array<double, BalancePolicy::kWeights>;

Weights random_weights(double size) {
  Weights weights{};
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = size * keyed_normal(7, i, 1);
  return weights;
}

// Of an ideal body: it follows its targets by the next cycle.
struct Walk {
  explicit Walk(std::shared_ptr<const BalancePolicy> policy)
      : motion({.balance = std::move(policy)}) {
    posture.angle = home();
  }
  void cycle(double left_m_per_s2, double yaw_rate = 0) {
    time_s += 0.012;
    posture.time = from_seconds(time_s);
    posture.inertial = host::Inertial{.time = posture.time,
                                      .yaw_rate_rad_per_s = yaw_rate,
                                      .forward_m_per_s2 = 0.5,
                                      .left_m_per_s2 = left_m_per_s2};
    for (const host::JointTarget& target : motion.step(from_seconds(time_s), posture))
      posture.angle[static_cast<std::size_t>(target.joint)] = target.angle_rad;
  }
  double time_s = 1;
  host::Posture posture;
  Motion motion;
};

TEST(BalancePolicy, IsAlikeForLeftAndRight) {
  const BalancePolicy policy(random_weights(0.5));
  BalancePolicy::Input x, mirrored;
  for (int i = 0; i < BalancePolicy::kInputs; ++i) {
    x[i] = keyed_normal(3, static_cast<std::uint64_t>(i), 1);
    // Fore and aft, and the sum of both knees, stay.
    mirrored[i] = i == 4 || i == 5 || i == 8 ? x[i] : -x[i];
  }
  const auto u = policy.evaluate(x), v = policy.evaluate(mirrored);
  for (int i = 0; i < BalancePolicy::kOutputs; ++i)
    EXPECT_DOUBLE_EQ(v[i], i == 1 ? -u[i] : u[i]) << "output " << i;
  EXPECT_GT(u.cwiseAbs().minCoeff(), 1e-6) << "and says something";
}

TEST(BalancePolicy, OfNilWeightsLeavesTheGaitAsItIs) {
  Walk with(std::make_shared<const BalancePolicy>(Weights{})), without(nullptr);
  // Without a distance: where a walk ends is odometry's, whose lag differs.
  for (Walk* walk : {&with, &without}) walk->motion.walk_on(0.04, 0);
  for (int i = 0; i < 1000; ++i) {
    const double shaken = std::sin(0.1 * i);
    with.cycle(shaken);
    without.cycle(shaken);
    ASSERT_EQ(with.posture.angle, without.posture.angle) << "cycle " << i;
  }
  EXPECT_EQ(with.motion.state(), State::walking);
}

// The zero of an accelerometer is off by up to 0.2 g: what it was while the robot stood is taken off.
TEST(Balance, TakesTheAccelerometersZeroOff) {
  const auto policy = std::make_shared<const BalancePolicy>(random_weights(0.5));
  Walk one(policy), other(policy);
  for (Walk* walk : {&one, &other}) {
    const double zero = walk == &one ? 0 : 1.9;
    for (int i = 0; i < 500; ++i) walk->cycle(zero);
    walk->motion.walk(0.1);
    for (int i = 0; i < 100; ++i) walk->cycle(zero + std::sin(0.3 * i));
  }
  for (std::size_t j = 0; j < one.posture.angle.size(); ++j)
    EXPECT_NEAR(one.posture.angle[j], other.posture.angle[j], 1e-3) << "joint " << j;
}

// Whatever the weights and whatever is felt, all is finite, and the phase goes on.
TEST(Balance, CorrectsWithinItsLimits) {
  const BalancePolicy policy(random_weights(100));
  Balance balance(policy);
  host::Posture posture;
  posture.angle = home();
  balance.sent(home());
  for (int i = 0; i < 2000; ++i) {
    posture.inertial =
        host::Inertial{.forward_m_per_s2 = 40 * keyed_normal(1, static_cast<std::uint64_t>(i), 1),
                       .left_m_per_s2 = 40 * keyed_normal(1, static_cast<std::uint64_t>(i), 2)};
    const Correction c =
        balance.step({.dt = 0.012,
                      .still = i < 300,
                      .walks = i >= 300,
                      .phase = 0.01 * i,
                      .amplitude = 1,
                      .yaw_rate = keyed_normal(1, static_cast<std::uint64_t>(i), 3),
                      .posture = &posture});
    EXPECT_GE(c.phase_rate, 0.1 - 1e-9);
    EXPECT_LE(c.phase_rate, 1.9 + 1e-9);
    EXPECT_LE(std::abs(c.roll), 10 * kDegree + 1e-9);
    EXPECT_GE(c.lift, -1e-9);
    EXPECT_LE(c.lift, 2 + 1e-9);
    EXPECT_GE(c.stride, -1e-9);
    EXPECT_LE(c.stride, 2 + 1e-9);
    EXPECT_LE(std::abs(c.height), 0.012 + 1e-9);
    EXPECT_LE(std::abs(c.lean), 6 * kDegree + 1e-9);
    if (i < 300) {
      EXPECT_EQ(c.phase_rate, 1) << "a robot that stands is left alone";
    }
  }
}

TEST(BalanceFile, IsReadWithCommentsAndCommas) {
  std::string text = "// of a test\n";
  for (int i = 0; i < BalancePolicy::kWeights; ++i)
    text += std::to_string(i % 7) + (i % 8 == 7 ? ",\n" : ", ");
  EXPECT_TRUE(BalancePolicy::parse(text + "// the end", "w.inc"));
}

TEST(BalanceFile, NamesWhatIsWrong) {
  const auto error_of = [](const std::string& text) {
    const auto policy = BalancePolicy::parse(text, "w.inc");
    return policy ? std::string() : policy.error().message;
  };
  EXPECT_EQ(error_of("1, 2\n3 x4"),
            "w.inc, line 2: 'x4' is not a weight; give a number from -1000 to 1000");
  EXPECT_NE(error_of("1e9").find("'1e9' is not a weight"), std::string::npos);
  EXPECT_NE(error_of("nan").find("'nan' is not a weight"), std::string::npos);
  EXPECT_NE(error_of("1 2 3").find("w.inc contains 3 numbers"), std::string::npos);
  EXPECT_NE(error_of("").find("w.inc contains 0 numbers"), std::string::npos);
}

}  // namespace
}  // namespace kaz::motion
