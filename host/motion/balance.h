// Balance while walking: a small neural network that corrects the gait from sensor readings.
// SPDX-License-Identifier: Apache-2.0
//
// The gait (gait.h) depends on time only, without feedback. A push that moves the center of mass close to a
// sole's edge topples the robot. In each control cycle, the network corrects the speed of the gait's phase,
// the roll of the trunk, and the height and length of the steps. The network also corrects the depth of the
// crouch and the forward lean of the trunk. Inputs of the network are the phase, the accelerometer, the gyro,
// and the deflection of the leg joints under load.
//
//   u = limit * tanh(W2 tanh(W1 x + b1) + b2),   x: kInputs inputs of order 1, u: kOutputs outputs
//
// The robot is symmetric, so the network is made symmetric, too. The matrix M mirrors the inputs, and the
// matrix N mirrors the outputs. The correction is (u(x) + N u(M x)) / 2. The weights are in
// learned_balance.inc, written by ./tools/dev study train-balance (docs/explanation/motion.md#balance).
// Units: m, s, rad. Frames and signs are the same as in gait.h.
#pragma once

#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>

#include "host/motion/inverse.h"
#include "host/robot/posture.h"
#include "shared/base/result.hpp"

namespace kaz::motion {

// Correction of the gait. The default values leave the gait unchanged.
struct Correction {
  double phase_rate = 1;  // factor on the speed of the phase
  double roll = 0;        // rad, added to the gait's roll of the trunk; positive to the right
  double lift = 1;        // factor on the height to which a swinging foot is lifted
  double stride = 1;      // factor on the length of the strides
  double height = 0;      // m, added to the height of the hips (Stance::z)
  double lean = 0;        // rad, added to the trunk's lean; positive forward
};

class BalancePolicy {
 public:
  static constexpr int kInputs = 12, kHidden = 8, kOutputs = 6;
  static constexpr int kWeights = (kInputs + 1) * kHidden + (kHidden + 1) * kOutputs;
  using Input = Eigen::Matrix<double, kInputs, 1>;
  using Output = Eigen::Matrix<double, kOutputs, 1>;

  // `weights`: the elements of W1 (row by row), b1, W2 (row by row) and b2.
  explicit BalancePolicy(std::span<const double, kWeights> weights);

  // Returns the trained policy from learned_balance.inc.
  static BalancePolicy learned();
  // Parses a text in the format of learned_balance.inc: kWeights numbers, separated by commas or white space.
  // In each line, the text after `//` is a comment. Fails (usage) if the text is not valid; the message
  // contains `name`, the line and the fault.
  static Result<BalancePolicy> parse(const std::string& text, const std::string& name);

  // Returns the outputs of the network, each from -1 to 1. The caller multiplies each output by its limit.
  Output evaluate(const Input& x) const;

 private:
  Eigen::Matrix<double, kHidden, kInputs> w1_;
  Eigen::Matrix<double, kHidden, 1> b1_;
  Eigen::Matrix<double, kOutputs, kHidden> w2_;
  Eigen::Matrix<double, kOutputs, 1> b2_;
};

// Filters the sensors' readings and computes the policy's inputs from the filtered readings. The zero offsets
// of the sensors are measured while the robot stands.
class Balance {
 public:
  explicit Balance(const BalancePolicy& policy) : policy_(policy) {}

  struct Sensed {
    double dt = 0;       // time since the last call of step(), s
    bool still = false;  // true: the robot stands, so the zero offsets of the sensors are measured
    bool walks = false;  // if false, the correction decays to the default
    double phase = 0, amplitude = 0;
    double yaw_rate = 0;                     // rad/s
    const host::Posture* posture = nullptr;  // not null; Posture::inertial must be set
  };
  // Returns the correction for the next cycle. Call step() once per control cycle.
  Correction step(const Sensed& sensed);
  // Records the leg targets that were sent in this cycle. The deflection of the leg joints is computed from
  // these targets.
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
