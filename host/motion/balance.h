// Balance while walking: a small network that corrects the gait from what the sensors have felt.
// SPDX-License-Identifier: Apache-2.0
//
// The hand-made gait (gait.h) follows time alone, and a push that carries the centre of mass near a
// sole's edge topples it. The network sees, each control cycle, the phase, the accelerometer, the
// gyro and by how much the legs' joints yield to their load, and answers with a correction of the
// gait: how fast its phase runs, how far the trunk rolls beside its plan, how high and far the feet
// step, how deep the robot crouches, how far it leans.
//
//   u = limit * tanh(W2 tanh(W1 x + b1) + b2),   x: kInputs numbers of about 1, u: kOutputs
//
// The robot has a left and a right that are alike, so the network is made alike, too: with M the
// mirror of the inputs and N that of the outputs the correction is (u(x) + N u(M x)) / 2. Weights:
// learned_balance.inc, written by ./tools/dev train-balance (docs/explanation/motion.md#balance).
// Units: m, s, rad. Frames and signs as in gait.h.
#pragma once

#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>

#include "host/motion/inverse.h"
#include "host/robot/posture.h"
#include "shared/base/result.hpp"

namespace kaz::motion {

// What is changed of the gait. The default changes nothing.
struct Correction {
  double phase_rate = 1;  // factor on the speed of the phase
  double roll = 0;        // rad, of the trunk beyond the gait's, + to the right
  double lift = 1;        // factor on the height of a swing
  double stride = 1;      // factor on the strides
  double height = 0;      // m, of the hips, beyond the stance's
  double lean = 0;        // rad, of the trunk forward
};

class BalancePolicy {
 public:
  static constexpr int kInputs = 12, kHidden = 8, kOutputs = 6;
  static constexpr int kWeights = (kInputs + 1) * kHidden + (kHidden + 1) * kOutputs;
  using Input = Eigen::Matrix<double, kInputs, 1>;
  using Output = Eigen::Matrix<double, kOutputs, 1>;

  // W1 by rows, b1, W2 by rows, b2.
  explicit BalancePolicy(std::span<const double, kWeights> weights);

  // The one that Kaz comes with.
  static BalancePolicy learned();
  // A text like learned_balance.inc: kWeights numbers with commas or white space between, // begins
  // a comment. Errors (usage): `name`, line, and what is wrong with it.
  static Result<BalancePolicy> parse(const std::string& text, const std::string& name);

  // -1..1 each.
  Output evaluate(const Input& x) const;

 private:
  Eigen::Matrix<double, kHidden, kInputs> w1_;
  Eigen::Matrix<double, kHidden, 1> b1_;
  Eigen::Matrix<double, kOutputs, kHidden> w2_;
  Eigen::Matrix<double, kOutputs, 1> b2_;
};

// The policy's inputs over time: filters of the sensors, whose zeros are measured while the robot stands.
class Balance {
 public:
  explicit Balance(const BalancePolicy& policy) : policy_(policy) {}

  struct Sensed {
    double dt = 0;       // s since the last
    bool still = false;  // the robot stands: the zeros are measured
    bool walks = false;  // else the correction fades
    double phase = 0, amplitude = 0;
    double yaw_rate = 0;                     // rad/s
    const host::Posture* posture = nullptr;  // with `inertial`
  };
  Correction step(const Sensed& sensed);
  // The leg targets that were sent in this cycle.
  void sent(const JointAngles& angles) { sent_ = angles; }

 private:
  struct Filter {
    double value = 0;
    void add(double x, double dt, double time_s) { value += dt / (time_s + dt) * (x - value); }
  };
  BalancePolicy policy_;
  std::optional<JointAngles> sent_;
  double left_zero_ = 0, forward_zero_ = 0, knees_zero_ = 0, zeroed_s_ = 0;
  Filter left_fast_, left_slow_, forward_fast_, forward_slow_, yaw_, load_, knees_, roll_fast_,
      roll_slow_;
  double drift_ = 0;  // m/s, leaky integral of the lateral acceleration
  BalancePolicy::Output smooth_ = BalancePolicy::Output::Zero();
};

}  // namespace kaz::motion
