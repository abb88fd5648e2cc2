// Equations of readings at stops and of a robot that stands on both soles.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "host/calibration/joint_readings.h"

namespace kaz::calibration {

namespace {

// Soles are flat on the floor within 0.1 degrees (they sink in, floors are not flat), a leg's length is
// right within 0.15 mm, and the mean specific force points up within 0.1 degrees.
constexpr double kFlatSigma = 0.1 * kDegree, kLengthSigma_m = 0.15e-3;
// Of the accelerometer, g: its zero, and how that wanders, one sigma and correlation time
// (shared/robot/kaz/sensors.xml). In a time t much shorter than that it moves by sigma sqrt(2 t / time).
constexpr double kZeroSigma_g = 0.1, kWanderSigma_g = 0.01, kWanderTime_s = 1000;
constexpr double kGravity = 9.80665;
constexpr std::array kLegJoints{host::l_hip_roll,    host::l_hip_pitch,  host::l_knee,
                                host::l_ankle_pitch, host::r_hip_roll,   host::r_hip_pitch,
                                host::r_knee,        host::r_ankle_pitch};

// Of a robot on both soles, from its joint angles, trunk frame.
//   0, 1: normal of the left sole less that of the right one, x and y: 0
//   2: height of the left sole above the right one along the normal, m: 0
//   3, 4: normal, x and y: direction of the specific force, which points up
using Closure = Eigen::Matrix<double, 5, 1>;
Closure closure_of(const host::JointAngles& angles) {
  const Eigen::Isometry3d left = host::trunk_from_sole(angles, host::Side::left);
  const Eigen::Isometry3d right = host::trunk_from_sole(angles, host::Side::right);
  const Eigen::Vector3d normals[] = {left.linear().col(2), right.linear().col(2)};
  const Eigen::Vector3d apart = normals[0] - normals[1], up = (normals[0] + normals[1]) / 2;
  Closure out;
  out << apart.x(), apart.y(), up.dot(left.translation() - right.translation()), up.x(), up.y();
  return out;
}

}  // namespace

void add_stops(JointEstimator& to, const std::vector<StopReading>& readings) {
  for (const StopReading& reading : readings)
    if (reading.fault.empty())
      to.add_angle(reading.joint, reading.code, stop_angle(reading.joint, reading.stop),
                   kStopSigma);
}

void add_stops(JointEstimator& to, int joint, const host::JointCalibration& line) {
  for (const Stop stop : {Stop::lower, Stop::upper}) {
    const double angle = stop_angle(joint, stop);
    to.add_angle(joint, code_at(line, angle), angle, kStoredSigma);
  }
}

std::vector<double> floor_unknowns(const std::vector<FloorReading>& readings) {
  std::vector<double> sigmas;
  double before_s = 0;
  for (const FloorReading& reading : readings) {
    const double sigma =
        sigmas.empty() ? kZeroSigma_g
                       : kWanderSigma_g * std::sqrt(2 * std::max(0.1, reading.time_s - before_s) /
                                                    kWanderTime_s);
    sigmas.insert(sigmas.end(), {sigma, sigma});
    before_s = reading.time_s;
  }
  return sigmas;
}

void add_floor(JointEstimator& to, const std::vector<FloorReading>& readings,
               const JointEstimator::Solution& about) {
  constexpr double kStep = 1e-5;  // rad, of the numerical Jacobian
  for (std::size_t number = 0; number < readings.size(); ++number) {
    const FloorReading& reading = readings[number];
    host::JointAngles at{};
    for (const int j : kLegJoints) {
      const auto i = static_cast<std::size_t>(j);
      at[i] = about.angle(j, reading.codes[i]);
    }
    const Closure here = closure_of(at);
    Eigen::Matrix<double, 5, 8> jacobian;
    for (std::size_t n = 0; n < kLegJoints.size(); ++n) {
      host::JointAngles moved = at;
      moved[static_cast<std::size_t>(kLegJoints[n])] += kStep;
      jacobian.col(static_cast<Eigen::Index>(n)) = (closure_of(moved) - here) / kStep;
    }
    // here + J (angles - at) = measured
    for (Eigen::Index row = 0; row < 5; ++row) {
      if (row >= 3 && !reading.has_force) continue;
      Equation equation;
      equation.sigma = row == 2 ? kLengthSigma_m : kFlatSigma;
      equation.value = -here[row];
      if (row >= 3) {
        const int axis = static_cast<int>(row) - 3;
        equation.value += (axis == 0 ? reading.forward_m_per_s2 : reading.left_m_per_s2) / kGravity;
        for (std::size_t k = 0; k <= number; ++k)
          equation.others.emplace_back(2 * static_cast<int>(k) + axis, 1.0);
      }
      for (std::size_t n = 0; n < kLegJoints.size(); ++n) {
        const int j = kLegJoints[n];
        const double weight = jacobian(row, static_cast<Eigen::Index>(n));
        equation.angles.push_back({j, reading.codes[static_cast<std::size_t>(j)], weight});
        equation.value += weight * at[static_cast<std::size_t>(j)];
      }
      to.add(equation);
    }
  }
}

}  // namespace kaz::calibration
