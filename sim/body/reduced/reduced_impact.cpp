// World in reduced coordinates: impacts of surfaces with restitution.
// SPDX-License-Identifier: Apache-2.0
//
// An impact takes no time. It is solved at the beginning of the step that finds it, without gravity:
//
//   M (v' - v) = sum J^T l        v, v': velocities before and after
//   normal    l_n >= 0, u_n' >= bounce, one of them with "=" (Newton's law)
//   friction  Coulomb's cone, with the sliding velocity u_t'
//
// The rest of the step begins with v'. A body that only leaves its contacts is in flight, where gravity is
// integrated exactly. A solver that reaches the bounce at the end of a step instead lifts the body by h v'
// without braking it: a gain of m g h v' in each impact.
//
// The step finds the contact at a depth d, with the velocity u_n. If a is the acceleration that presses the
// bodies together, their speed at the surface was u_s^2 = u_n^2 - 2 a d, and after the bounce they pass the
// surface with e u_s. At the depth d, this is
//
//   bounce^2 = e^2 u_s^2 + 2 a d
//
// so no energy is gained or lost, wherever in the step the impact is.
//
// With friction, or if contacts close while others open, Newton's law can add energy (T. Kane & D. Levinson,
// "Dynamics: Theory and Applications", 1985, section 5.10). Then v' is moved toward v_p, the velocities after
// the same impact without restitution, which never adds energy:
//
//   v(s) = v_p + s (v' - v_p),  the largest s in [0, 1] without a gain of kinetic energy
//
// Normal velocities stay at least 0, and the impulses stay in their cones, since both sets are convex.
#include <algorithm>
#include <cmath>

#include "sim/body/reduced/reduced_world.h"

namespace kaz::sim {
namespace {

using Eigen::Vector3d;

// Compliance along the normal in an impact, m/s per N s. Costs 1e-6 of the bounce of 10 kg.
constexpr double kImpactSoftness = 1e-7;
// Point::give_share in an impact, whose friction cannot go on in the next step.
constexpr double kImpactGive = 1e-3;

// x . M y over the coordinates of an island. `product` receives M y.
double inertia_product(const BlockMatrix& matrix, const BlockMatrix::Island& island,
                       std::span<const double> x, std::span<const double> y,
                       std::vector<double>& product) {
  product.resize(y.size());
  matrix.multiply(island, y.data(), product.data());
  double sum = 0;
  for (int b = 0; b < island.blocks.length; ++b) {
    const BlockMatrix::Range& range = matrix.block(island, b);
    for (int i = range.first; i < range.first + range.length; ++i)
      sum += x[static_cast<std::size_t>(i)] * product[static_cast<std::size_t>(i)];
  }
  return sum;
}

}  // namespace

// Acceleration that presses the bodies together, m/s^2: gravity of free bodies; the robot counts as held.
double ReducedWorld::pressing(const Touch& touch) const {
  const auto falls = [this](int body) { return body >= 0 && !of_robot(body) ? 1.0 : 0.0; };
  return std::max(0.0, (falls(touch.body_b) - falls(touch.body_a)) * touch.normal.dot(gravity_));
}

double ReducedWorld::approach(const Touch& touch) const {
  return touch.normal.dot(velocity_at(touch.body_b, touch.at) -
                          velocity_at(touch.body_a, touch.at));
}

// Separation velocity after an impact, m/s. 0: the contact does not bounce. Bounces that end within the next
// step are left out, so that bodies come to rest.
double ReducedWorld::bounce(const Touch& touch) const {
  const Surface& surface = touch.surface;
  if (surface.restitution <= 0) return 0;
  const double speed = approach(touch);
  if (speed <= surface.bounce_threshold || speed <= 0) return 0;
  const double press = pressing(touch), fall = 2 * press * touch.depth;
  const double up = surface.restitution * std::sqrt(std::max(0.0, speed * speed - fall));
  return up > press * step_s_ ? std::sqrt(up * up + fall) : 0;
}

// Solves the impacts of this step and changes the velocities of tree and objects. work.struck receives the
// impulses, in the order of work.pushes; it stays empty if nothing bounces.
void ReducedWorld::strike(Work& work) {
  work.struck.clear();
  const std::span<const Touch> touches = work.contacts.touches();
  if (std::ranges::none_of(touches, [this](const Touch& touch) { return bounce(touch) > 0; }))
    return;
  begin_rows(work);
  for (std::size_t i = 0; i < touches.size(); ++i) {
    VelocitySolver::Point point;
    if (!place_point(work, i, point)) continue;
    point.target = bounce(touches[i]);
    if (point.target > 0) point.softness = kImpactSoftness;
    point.give_share = kImpactGive;
    add_point(work, i, point);
  }
  make_joint_rows(work);
  make_coupling_rows(work);
  make_passive_rows(work);
  work.solver.hold(work.velocity);
  work.solver.close();
  work.solver.multiply(work.velocity.data(), work.momentum.data());
  work.unstruck = work.velocity;
  run_solver(work);
  for (std::size_t i = 0; i < work.pushes.size(); ++i)
    work.struck.push_back(work.solver.impulse(i));
  limit_energy(work);
  for (std::size_t i = 0; i < tree_.velocity.size(); ++i) {
    velocity_before_[i] += work.velocity[i] - work.unstruck[i];
    tree_.velocity[i] = work.velocity[i];
  }
  tree_.velocities();
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (work.coordinate_of[i] < 0) continue;
    const double* v = work.velocity.data() + work.coordinate_of[i];
    objects_[i].strike({v[3], v[4], v[5]}, {v[0], v[1], v[2]});
  }
}

// Reduces the restitution in islands that gained kinetic energy (see the top of this file).
void ReducedWorld::limit_energy(Work& work) {
  const BlockMatrix& matrix = work.solver.matrix();
  std::vector<double>& product = work.product;
  const auto energy = [&](const auto& island, std::span<const double> v) {
    return inertia_product(matrix, island, v, v, product);
  };
  const auto gains = [&](const BlockMatrix::Island& island) {
    return energy(island, work.velocity) > energy(island, work.unstruck);
  };
  if (std::ranges::none_of(matrix.islands(), gains)) return;
  work.elastic = work.velocity;
  for (std::size_t i = 0; i < work.pushes.size(); ++i) work.solver.set_target(i, 0);
  run_solver(work);
  std::vector<double>& more = work.elastic;
  for (std::size_t i = 0; i < more.size(); ++i) more[i] -= work.velocity[i];
  work.share.clear();
  for (const BlockMatrix::Island& island : matrix.islands()) {
    // T(s) - T(before) = c + 2 b s + a s^2, c <= 0.
    const double a = energy(island, more);
    const double b = inertia_product(matrix, island, more, work.velocity, product);
    const double c = std::min(0.0, energy(island, work.velocity) - energy(island, work.unstruck));
    const bool whole = a + 2 * b + c <= 0;
    work.share.push_back(whole ? 1 : std::clamp((std::sqrt(b * b - a * c) - b) / a, 0.0, 1.0));
  }
  for (std::size_t i = 0; i < more.size(); ++i)
    work.velocity[i] +=
        work.share[static_cast<std::size_t>(matrix.island_of(static_cast<int>(i)))] * more[i];
  for (std::size_t i = 0; i < work.pushes.size(); ++i) {
    const double share = work.share[static_cast<std::size_t>(work.solver.island_of(i))];
    const VelocitySolver::Impulse& plastic = work.solver.impulse(i);
    work.struck[i] = plastic + share * (work.struck[i] - plastic);
  }
}

}  // namespace kaz::sim
