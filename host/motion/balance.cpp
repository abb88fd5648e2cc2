// Features, network and limits of the balance policy.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/balance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include "shared/base/angle.hpp"
#include "shared/base/number_text.hpp"

namespace kaz::motion {

namespace {

constexpr double kFast_s = 0.025, kSlow_s = 0.15, kDrift_s = 0.4, kSmooth_s = 0.03, kZero_s = 4.0;

// Full range of each output: phase rate, roll, lift, stride, height, lean.
constexpr double kPhase = 0.9, kRoll = 10 * kDegree, kLift = 1.0, kStride = 1.0, kHeight = 0.012,
                 kLean = 6 * kDegree;

// The mirror: inputs and outputs that change their sign when left and right are exchanged.
const BalancePolicy::Input kMirrorInput{{-1, -1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1}};
const BalancePolicy::Output kMirrorOutput{{1, -1, 1, 1, 1, 1}};

}  // namespace

BalancePolicy::BalancePolicy(std::span<const double, kWeights> weights) {
  const double* at = weights.data();
  const auto take = [&at](auto& matrix) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row)
      for (Eigen::Index column = 0; column < matrix.cols(); ++column) matrix(row, column) = *at++;
  };
  take(w1_);
  take(b1_);
  take(w2_);
  take(b2_);
}

BalancePolicy::Output BalancePolicy::evaluate(const Input& x) const {
  const auto once = [this](const Input& in) -> Output {
    const Eigen::Matrix<double, kHidden, 1> hidden = (w1_ * in + b1_).array().tanh();
    return (w2_ * hidden + b2_).array().tanh();
  };
  return (once(x) + kMirrorOutput.cwiseProduct(once(kMirrorInput.cwiseProduct(x)))) / 2;
}

BalancePolicy BalancePolicy::learned() {
  static constexpr std::array<double, kWeights> kLearned{
#include "host/motion/learned_balance.inc"
  };
  return BalancePolicy(kLearned);
}

Result<BalancePolicy> BalancePolicy::parse(const std::string& text, const std::string& name) {
  constexpr double kMost = 1000;
  std::vector<double> weights;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line = line.substr(0, line.find("//"));
    std::ranges::replace(line, ',', ' ');
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      const auto weight = parse_number<double>(word);
      if (!weight || std::abs(*weight) > kMost)
        return fail(Fault::usage, name + ", line " + std::to_string(number) + ": '" +
                                      word.substr(0, 20) +
                                      "' is not a weight; give a number from -1000 to 1000");
      weights.push_back(*weight);
    }
  }
  if (weights.size() != kWeights)
    return fail(Fault::usage, name + " contains " + std::to_string(weights.size()) +
                                  " numbers, but a balance policy has " + std::to_string(kWeights) +
                                  " weights; ./tools/dev study train-balance writes such files");
  return BalancePolicy(std::span<const double, kWeights>(weights));
}

Correction Balance::step(const Sensed& now) {
  const auto& angle = now.posture->angle;
  const double dt = now.dt;
  const auto& inertial = *now.posture->inertial;
  // By how much a joint yields, rad.
  const auto yields = [&](int joint) {
    const auto j = static_cast<std::size_t>(joint);
    return sent_ ? (*sent_)[j] - angle[j] : 0.0;
  };
  const double knees = yields(host::l_knee) + yields(host::r_knee);
  if (now.still && dt > 0) {
    // Mean of the last seconds.
    zeroed_s_ = std::min(zeroed_s_ + dt, kZero_s);
    const double share = dt / zeroed_s_;
    left_zero_ += share * (inertial.left_m_per_s2 - left_zero_);
    forward_zero_ += share * (inertial.forward_m_per_s2 - forward_zero_);
    knees_zero_ += share * (knees - knees_zero_);
  }
  const double left = inertial.left_m_per_s2 - left_zero_;
  const double forward = inertial.forward_m_per_s2 - forward_zero_;
  left_fast_.add(left, dt, kFast_s);
  left_slow_.add(left, dt, kSlow_s);
  forward_fast_.add(forward, dt, kFast_s);
  forward_slow_.add(forward, dt, kSlow_s);
  yaw_.add(now.yaw_rate, dt, kFast_s);
  load_.add(yields(host::l_knee) - yields(host::r_knee), dt, kFast_s);
  knees_.add(knees - knees_zero_, dt, kFast_s);
  const double roll = (yields(host::l_hip_roll) + yields(host::r_hip_roll)) / 2;
  roll_fast_.add(roll, dt, kFast_s);
  roll_slow_.add(roll, dt, kSlow_s);
  drift_ += dt * (left - drift_ / kDrift_s);

  BalancePolicy::Output u = BalancePolicy::Output::Zero();
  if (now.walks) {
    const double turn = 2 * std::numbers::pi * now.phase;
    const BalancePolicy::Input x{{now.amplitude * std::sin(turn), now.amplitude * std::cos(turn),
                                  left_fast_.value / 3, left_slow_.value / 3,
                                  forward_fast_.value / 3, forward_slow_.value / 3, yaw_.value,
                                  load_.value / 0.05, knees_.value / 0.05, roll_fast_.value / 0.03,
                                  roll_slow_.value / 0.03, drift_ / 0.3}};
    u = policy_.evaluate(x.cwiseMax(-5).cwiseMin(5));
  }
  smooth_ += dt / (kSmooth_s + dt) * (u - smooth_);
  return {.phase_rate = 1 + kPhase * smooth_[0],
          .roll = kRoll * smooth_[1],
          .lift = 1 + kLift * smooth_[2],
          .stride = 1 + kStride * smooth_[3],
          .height = kHeight * smooth_[4],
          .lean = kLean * smooth_[5]};
}

}  // namespace kaz::motion
