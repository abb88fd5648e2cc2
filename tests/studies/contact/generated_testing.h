// For tests: tosses that an engine generates.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "shared/base/random.hpp"
#include "tests/studies/contact/engine.h"

namespace kaz::contact::test {

// Fills in the velocities by differences to the previous pose, as in the recorded files. The velocities of
// the first sample stay.
inline void differentiate(Toss& toss) {
  toss.velocity.resize(toss.path.size());
  toss.spin.resize(toss.path.size());
  for (std::size_t i = 1; i < toss.path.size(); ++i) {
    toss.velocity[i] = kRate * (toss.path[i].at - toss.path[i - 1].at);
    const Eigen::AngleAxisd turn(toss.path[i].turn * toss.path[i - 1].turn.conjugate());
    toss.spin[i] = kRate * turn.angle() * turn.axis();
  }
}

// Returns `count` tosses with the even numbers 0, 2 and so on. Each starts 0.1 to 0.15 m above the floor,
// with up to 1.2 m/s and 6 rad/s along each axis.
inline std::vector<Toss> generated_tosses(const Engine& engine, std::span<const double> values,
                                          int count, std::size_t samples) {
  Random random(7);
  const auto vector = [&](double most) {
    Eigen::Vector3d v;
    for (double& x : v) x = most * (2 * random.uniform() - 1);
    return v;
  };
  std::vector<Toss> tosses;
  for (int i = 0; i < count; ++i) {
    Toss toss;
    toss.number = 2 * i;
    Pose start;
    start.at = {0, 0, 0.1 + 0.05 * random.uniform()};
    start.turn = Eigen::AngleAxisd(3 * random.uniform(), vector(1).normalized());
    toss.path.assign(samples, start);
    toss.velocity.push_back(vector(1.2));
    toss.spin.push_back(vector(6));
    toss.path = engine.simulate(toss, values).value();
    differentiate(toss);
    tosses.push_back(toss);
  }
  return tosses;
}

}  // namespace kaz::contact::test
