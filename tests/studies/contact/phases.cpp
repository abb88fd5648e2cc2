// Phases of a toss, contributions to its error, and the final face.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/contact/phases.h"

#include <cmath>

#include "tests/studies/contact/score.h"

namespace kaz::contact {
namespace {

constexpr double kImpactSpeed = 0.1;    // m/s in a sample, beyond gravity
constexpr double kImpactSpin = 1;       // rad/s in a sample
constexpr std::size_t kSameImpact = 3;  // samples
constexpr double kRockingSpin = 2;      // rad/s
constexpr double kSlidingSpeed = 0.05;  // m/s

bool has_impact(const Toss& toss, std::size_t i) {
  const Eigen::Vector3d fall(0, 0, -kGravity / kRate);
  return (toss.velocity[i] - toss.velocity[i - 1] - fall).norm() > kImpactSpeed ||
         (toss.spin[i] - toss.spin[i - 1]).norm() > kImpactSpin;
}

}  // namespace

std::vector<Phase> phases_of(const Toss& toss) {
  std::vector<Phase> phases(toss.path.size(), Phase::flight);
  std::size_t first = 0;
  Phase phase = Phase::flight;
  for (std::size_t i = 1; i < phases.size(); ++i) {
    const bool impact = has_impact(toss, i);
    if (phase == Phase::flight && impact) {
      first = i;
      phase = Phase::first_impact;
    } else if (phase == Phase::first_impact && impact && i > first + kSameImpact) {
      phase = Phase::rocking;
    }
    phases[i] = phase;
    if (phase != Phase::rocking || toss.spin[i].norm() >= kRockingSpin) continue;
    phases[i] = toss.velocity[i].head<2>().norm() >= kSlidingSpeed ? Phase::sliding : Phase::rest;
  }
  return phases;
}

PhaseErrors phase_errors(const Toss& toss, const Path& simulated) {
  PhaseErrors errors{};
  const std::vector<Phase> phases = phases_of(toss);
  double before = 0;
  const auto count = static_cast<double>(simulated.size());
  for (std::size_t i = 0; i < simulated.size(); ++i) {
    const double now = pose_error(toss.path[i], simulated[i]);
    errors[static_cast<std::size_t>(phases[i])] +=
        (now - before) * (count - static_cast<double>(i)) / count;
    before = now;
  }
  return errors;
}

int final_face(const Path& path) {
  const Eigen::Vector3d up = path.back().turn.conjugate() * Eigen::Vector3d::UnitZ();
  Eigen::Index axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  return static_cast<int>(2 * axis) + (up[axis] < 0 ? 1 : 0);
}

}  // namespace kaz::contact
