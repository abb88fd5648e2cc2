// Bayesian linear regression of potentiometers, and the line of least error for each.
// SPDX-License-Identifier: Apache-2.0
#include "host/calibration/joint_estimator.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace kaz::calibration {

namespace {

constexpr int kGrid = 61;  // angles at which a joint's error is evaluated

double rounded(double rad) {
  return std::round(rad * KZ_ANGLE_PER_RAD) / KZ_ANGLE_PER_RAD;
}

using Terms = Eigen::Matrix<double, kPotTerms, 1>;
Terms terms_at(double code) {
  const auto terms = pot_terms(code);
  return Terms(terms.data());
}

// Least squares of the posterior's mean over the range, weighted alike everywhere; errors from its residual
// and the posterior's variance.
JointEstimate line_for(int joint, const Terms& mean,
                       const Eigen::Matrix<double, kPotTerms, kPotTerms>& covariance) {
  const host::JointCalibration nominal = nominal_calibration(joint);
  const host::JointInfo& info = host::joint_table()[static_cast<std::size_t>(joint)];
  std::array<double, kGrid> codes, angles;
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  const auto x_of = [](double code) { return (code - KZ_POT_CODES / 2) / (KZ_POT_CODES / 2); };
  for (std::size_t i = 0; i < kGrid; ++i) {
    const double at =
        info.lower_rad + (info.upper_rad - info.lower_rad) * static_cast<double>(i) / (kGrid - 1);
    codes[i] = code_at(nominal, at);
    angles[i] = angle_at(nominal, codes[i]) + terms_at(codes[i]).dot(mean);
    mean_x += x_of(codes[i]) / kGrid;
    mean_y += angles[i] / kGrid;
  }
  for (std::size_t i = 0; i < kGrid; ++i) {
    const double x = x_of(codes[i]) - mean_x;
    xx += x * x;
    xy += x * (angles[i] - mean_y);
  }
  JointEstimate out;
  out.line.scale_rad = rounded(xy / xx);
  out.line.centre_rad = rounded(mean_y - out.line.scale_rad * mean_x);
  double squares = 0, worst = 0;
  for (std::size_t i = 0; i < kGrid; ++i) {
    const Terms terms = terms_at(codes[i]);
    const double off = angles[i] - angle_at(out.line, codes[i]);
    const double square = off * off + terms.dot(covariance * terms);
    squares += square / kGrid;
    worst = std::max(worst, square);
  }
  out.expected_error_rad = std::sqrt(squares);
  out.worst_error_rad = std::sqrt(worst);
  const double middle = codes[kGrid / 2];
  out.shift_rad = angle_at(out.line, middle) - angle_at(nominal, middle);
  return out;
}

}  // namespace

JointEstimator::JointEstimator(const std::vector<double>& others) {
  const auto size = static_cast<Eigen::Index>(KZ_JOINTS * kPotTerms + others.size());
  prior_.resize(size);
  for (int j = 0; j < KZ_JOINTS; ++j)
    for (int k = 0; k < kPotTerms; ++k)
      prior_[j * kPotTerms + k] = kPotPrior[static_cast<std::size_t>(k)];
  for (std::size_t n = 0; n < others.size(); ++n)
    prior_[KZ_JOINTS * kPotTerms + static_cast<Eigen::Index>(n)] = others[n];
  information_ = prior_.array().square().inverse().matrix().asDiagonal();
  right_ = Eigen::VectorXd::Zero(size);
}

Eigen::VectorXd JointEstimator::row_of(const Equation& equation) const {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(prior_.size());
  for (const AngleTerm& term : equation.angles)
    row.segment<kPotTerms>(term.joint * kPotTerms) += term.weight * terms_at(term.code);
  for (const auto& [number, weight] : equation.others)
    row[KZ_JOINTS * kPotTerms + number] += weight;
  return row;
}

void JointEstimator::add(const Equation& equation) {
  // value - sum w nominal = row . unknowns
  Equation reduced = equation;
  for (const AngleTerm& term : equation.angles)
    reduced.value -= term.weight * angle_at(nominal_calibration(term.joint), term.code);
  const Eigen::VectorXd row = row_of(reduced);
  const double weight = 1 / (equation.sigma * equation.sigma);
  information_ += weight * row * row.transpose();
  right_ += weight * reduced.value * row;
  equations_.push_back(std::move(reduced));
}

void JointEstimator::add_angle(int joint, double code, double angle_rad, double sigma_rad) {
  add({.angles = {{joint, code}}, .value = angle_rad, .sigma = sigma_rad});
}

double JointEstimator::Solution::angle(int joint, double code) const {
  return angle_at(nominal_calibration(joint), code) +
         terms_at(code).dot(unknowns.segment<kPotTerms>(joint * kPotTerms));
}

JointEstimator::Solution JointEstimator::solve() const {
  Solution solution;
  const Eigen::LLT<Eigen::MatrixXd> factor(information_);
  solution.unknowns = factor.solve(right_);
  const Eigen::MatrixXd covariance =
      factor.solve(Eigen::MatrixXd::Identity(prior_.size(), prior_.size()));
  for (int j = 0; j < KZ_JOINTS; ++j) {
    const Eigen::Index at = j * kPotTerms;
    solution.joints[static_cast<std::size_t>(j)] =
        line_for(j, solution.unknowns.segment<kPotTerms>(at),
                 covariance.block<kPotTerms, kPotTerms>(at, at));
  }
  for (const Equation& equation : equations_) {
    const double residual = row_of(equation).dot(solution.unknowns) - equation.value;
    solution.worst_residual =
        std::max(solution.worst_residual, std::abs(residual) / equation.sigma);
    std::uint32_t counted = 0;
    for (const AngleTerm& term : equation.angles) {
      if (counted >> term.joint & 1) continue;
      counted |= 1u << term.joint;
      ++solution.joints[static_cast<std::size_t>(term.joint)].equations;
    }
  }
  return solution;
}

}  // namespace kaz::calibration
