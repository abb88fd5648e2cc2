// Calibration of all joints from readings at known angles and from equations between joint angles.
// SPDX-License-Identifier: Apache-2.0
//
// Unknown are the terms of each potentiometer (pot_model.h) and what the caller adds, such as the zero of an
// accelerometer. Each is normally distributed about zero before anything is measured; an equation
//   sum w_i angle_{j_i}(code_i) + sum v_n x_n = value + noise,  noise of one sigma
// is linear in them. The estimate is the mean of the posterior (Bayesian linear regression, Bishop 2006,
// 3.3), so what no equation determines stays at its expectation, and its uncertainty is counted.
//
// The board stores a line for each joint. It is the one with the least mean square error over the joint's
// range. What is left of the curve, and what is uncertain, is the error that `JointEstimate` expects.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "host/calibration/pot_model.h"

namespace kaz::calibration {

struct AngleTerm {
  int joint;
  double code;
  double weight = 1;
};

struct Equation {
  std::vector<AngleTerm> angles;
  std::vector<std::pair<int, double>> others = {};  // number of the additional unknown, weight
  double value = 0, sigma = 1;                      // rad, or the unit of the weights times rad
};

struct JointEstimate {
  host::JointCalibration line;  // rounded to the board's 100 urad
  double shift_rad = 0;         // of the angle in the middle of the joint's range, new less nominal
  double expected_error_rad = 0;  // of the line: root mean square over the joint's range
  double worst_error_rad = 0;     // one standard deviation where it is largest
  int equations = 0;              // that contain the joint
};

class JointEstimator {
 public:
  // `others`: one standard deviation of each additional unknown.
  explicit JointEstimator(const std::vector<double>& others = {});

  void add(const Equation& equation);
  void add_angle(int joint, double code, double angle_rad, double sigma_rad);

  struct Solution {
    std::array<JointEstimate, KZ_JOINTS> joints;
    // Mean of the posterior: kPotTerms for each joint, then the additional unknowns.
    Eigen::VectorXd unknowns;
    // Largest residual of an equation, in its sigmas: above 4 something was measured wrongly.
    double worst_residual = 0;
    double angle(int joint, double code) const;  // rad
  };
  Solution solve() const;

 private:
  Eigen::VectorXd row_of(const Equation& equation) const;
  Eigen::VectorXd prior_;  // standard deviations
  Eigen::MatrixXd information_;
  Eigen::VectorXd right_;
  std::vector<Equation> equations_;
};

}  // namespace kaz::calibration
