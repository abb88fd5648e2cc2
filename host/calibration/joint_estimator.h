// Calibration of all joints from readings at known angles and from equations between joint angles.
// SPDX-License-Identifier: Apache-2.0
//
// The unknowns are the terms of each potentiometer (pot_model.h), and additional unknowns of the caller, such
// as the zero of an accelerometer. Before any measurement, each unknown is normally distributed about zero.
// Each equation is linear in the unknowns, and its noise has the standard deviation sigma:
//   sum w_i angle_{j_i}(code_i) + sum v_n x_n = value + noise
// The estimate is the mean of the posterior (Bayesian linear regression, Bishop 2006, section 3.3). So an
// unknown keeps its prior mean if no equation determines it. The expected errors include the uncertainty of
// this unknown.
//
// The board stores one straight line for each joint. This line is a least-squares fit to the estimated curve
// over the joint's range. The expected error in `JointEstimate` includes the curve's deviation from this line
// and the remaining uncertainty.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "host/calibration/pot_model.h"

namespace kaz::calibration {

// The angle of a joint at a potentiometer code, times a weight. A code may be a mean, so it need not be
// whole.
struct AngleTerm {
  int joint;
  double code;
  double weight = 1;
};

// A linear equation between joint angles and additional unknowns, with the standard deviation of its noise.
struct Equation {
  std::vector<AngleTerm> angles;
  std::vector<std::pair<int, double>> others = {};  // pairs: index of the unknown, its weight
  double value = 0, sigma = 1;                      // unit: rad times the unit of AngleTerm::weight
};

struct JointEstimate {
  // `line.centre_rad` and `line.scale_rad` are multiples of 100 urad. The board's calibration has this unit.
  host::JointCalibration line;
  // Difference between two lines at the code in the middle of the joint's range: angle on `line` minus angle
  // on the nominal line.
  double shift_rad = 0;
  // Expected error of the line, root mean square over the joint's range.
  double expected_error_rad = 0;
  double worst_error_rad = 0;  // largest standard deviation of the error over the joint's range
  int equations = 0;           // number of equations that contain the joint
};

// Collects equations and solves for the calibration of all joints.
class JointEstimator {
 public:
  // `others`: prior standard deviation of each additional unknown.
  explicit JointEstimator(const std::vector<double>& others = {});

  void add(const Equation& equation);
  void add_angle(int joint, double code, double angle_rad, double sigma_rad);

  struct Solution {
    std::array<JointEstimate, KZ_JOINTS> joints;
    // Mean of the posterior: kPotTerms for each joint, in rad, then the additional unknowns.
    Eigen::VectorXd unknowns;
    // Largest residual of an equation, in units of its sigma. A value above 4 means that a measurement was
    // wrong.
    double worst_residual = 0;
    double angle(int joint, double code) const;  // rad
  };
  Solution solve() const;

 private:
  Eigen::VectorXd row_of(const Equation& equation) const;
  Eigen::VectorXd prior_;  // prior standard deviations
  Eigen::MatrixXd information_;
  Eigen::VectorXd right_;
  std::vector<Equation> equations_;
};

}  // namespace kaz::calibration
