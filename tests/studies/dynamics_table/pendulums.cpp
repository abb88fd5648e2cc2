// Double and triple pendulum released horizontally: energy error over the step length, and the path of the
// tip against a reference solution of the equations of motion.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "tests/studies/dynamics_table/scene.h"

namespace kaz::dynamics_table {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using sim::test::kFreeRotor;
using sim::test::kRodInertia;
using sim::test::kRodLength;
using sim::test::kRodMass;

// Lagrange's equations of the planar chain; t: absolute angles from the direction of gravity.
//   M_ij = m_ij cos(t_i - t_j) + rotors,  m_ij: mass below both times their lengths
//   sum_j M_ij t_j'' = -sum_j m_ij sin(t_i - t_j) t_j'^2 - g_i sin t_i
// Rotors rotate with the joints, at t_i' - t_(i-1)'.
class Lagrange {
 public:
  explicit Lagrange(int rods)
      : lever_(rods, rods), rotor_(Eigen::MatrixXd::Zero(rods, rods)), weight_(rods) {
    constexpr double half = kRodLength / 2;
    for (int i = 0; i < rods; ++i) {
      for (int j = 0; j < rods; ++j) {
        const int low = std::max(i, j);
        const double below = kRodMass * (rods - 1 - low) * kRodLength * kRodLength;
        lever_(i, j) = below + kRodMass * (i == j ? half * half : half * kRodLength) +
                       (i == j ? kRodInertia : 0);
      }
      weight_(i) = kG * kRodMass * (half + (rods - 1 - i) * kRodLength);
      rotor_(i, i) += kFreeRotor;
      if (i == 0) continue;
      rotor_(i - 1, i - 1) += kFreeRotor;
      rotor_(i, i - 1) -= kFreeRotor;
      rotor_(i - 1, i) -= kFreeRotor;
    }
    angle = VectorXd::Constant(rods, -M_PI / 2);
    rate = VectorXd::Zero(rods);
  }
  VectorXd angle, rate;  // rad, rad/s

  // Classical fourth-order Runge-Kutta, 10 steps.
  void half_millisecond() {
    constexpr double h = 5e-5;
    for (int i = 0; i < 10; ++i) {
      const VectorXd a1 = faster(angle, rate), w2 = rate + h / 2 * a1;
      const VectorXd a2 = faster(angle + h / 2 * rate, w2), w3 = rate + h / 2 * a2;
      const VectorXd a3 = faster(angle + h / 2 * w2, w3), w4 = rate + h * a3;
      const VectorXd a4 = faster(angle + h * w3, w4);
      angle += h / 6 * (rate + 2 * w2 + 2 * w3 + w4);
      rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
  }
  // Of the last rod's end: along -x of the world as it hangs level, and down.
  Eigen::Vector2d tip() const {
    return kRodLength * Eigen::Vector2d(angle.array().sin().sum(), angle.array().cos().sum());
  }

 private:
  VectorXd faster(const VectorXd& t, const VectorXd& w) const {
    const auto n = t.size();
    Eigen::MatrixXd mass = rotor_;
    VectorXd force(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      force(i) = -weight_(i) * std::sin(t(i));
      for (Eigen::Index j = 0; j < n; ++j) {
        mass(i, j) += lever_(i, j) * std::cos(t(i) - t(j));
        force(i) -= lever_(i, j) * std::sin(t(i) - t(j)) * w(j) * w(j);
      }
    }
    return mass.llt().solve(force);
  }
  Eigen::MatrixXd lever_, rotor_;
  VectorXd weight_;
};

// The chain extends along -z at zero angles; gravity along +x is as if it were released horizontally.
struct Swing {
  Swing(const std::string& stepper, int rods, double step_s) : count(rods), step(step_s) {
    sim::WorldModel around;
    around.gravity = {kG, 0, 0};
    world = world_of(stepper, around, sim::test::chain(rods, false), sim::test::free_motor(), step);
    now = poses();
  }
  std::vector<Eigen::Isometry3d> poses() const {
    std::vector<Eigen::Isometry3d> all;
    for (int i = 0; i < count; ++i)
      all.push_back(world->link_pose(std::string("rod").append(std::to_string(i))));
    return all;
  }
  void go() {
    before = now;
    world->step(std::vector<sim::MotorDrive>(static_cast<std::size_t>(count)), kVolts);
    now = poses();
  }
  Vector3d tip() const { return now.back() * Vector3d(0, 0, -kRodLength); }
  // Kinetic (rotors included) and potential energy at the middle of the last step, J; velocities are
  // differences of positions.
  std::pair<double, double> energy() const {
    const Vector3d centre(0, 0, -kRodLength / 2);
    double kinetic = 0, potential = 0, carrier = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const Vector3d at = now[i] * centre, was = before[i] * centre;
      const Eigen::AngleAxisd turn(before[i].linear().transpose() * now[i].linear());
      const double w = turn.axis().y() * turn.angle() / step;
      kinetic += kRodMass * ((at - was) / step).squaredNorm() / 2 + kRodInertia * w * w / 2 +
                 kFreeRotor * (w - carrier) * (w - carrier) / 2;
      potential -= kRodMass * kG * (at + was).x() / 2;
      carrier = w;
    }
    return {kinetic, potential};
  }
  int count;
  double step;
  std::unique_ptr<sim::StagedWorld> world;
  std::vector<Eigen::Isometry3d> before, now;
};

// Max energy error in 10 s relative to the max kinetic energy.
double energy_error(const std::string& stepper, int rods, double step_s) {
  Swing swing(stepper, rods, step_s);
  double max_kinetic = 0, off = 0;
  for (long i = std::lround(10 / step_s); i > 0; --i) {
    swing.go();
    const auto [kinetic, potential] = swing.energy();
    max_kinetic = std::max(max_kinetic, kinetic);
    off = std::max(off, std::abs(kinetic + potential));  // it starts level and at rest: 0
  }
  return off / max_kinetic;
}

}  // namespace

void swing(const std::string& stepper, Table& table) {
  for (const int rods : {2, 3}) {
    Swing swing(stepper, rods, kStep);
    Lagrange exact(rods);
    double off = 0, off_later = 0;
    for (int i = 0; i < 1000; ++i) {
      swing.go();
      if (i == 0) exact.half_millisecond();
      exact.half_millisecond();
      // World: gravity along x, rods along -z at the start, where their angle is -90 degrees.
      const Vector3d place = swing.tip();
      const Eigen::Vector2d tip(place.z(), place.x());
      off = std::max(off, (tip - exact.tip()).norm());
      exact.half_millisecond();
      off_later = std::max(off_later, (tip - exact.tip()).norm());
    }
    const std::string scene = kPendulums[static_cast<std::size_t>(rods - 2)];
    table.put(stepper, scene, "energy, 10 s", "constant", "", energy_error(stepper, rods, kStep));
    table.put(stepper, scene, "path of the tip, 1 s", "Lagrange's equations", "m", off);
    table.put(stepper, scene, "the same against half a step later", "Lagrange's equations", "m",
              off_later);
  }
}

void swing_by_step(const std::string& stepper, Table& table) {
  for (const int rods : {2, 3}) {
    auto& errors = table.energies[kPendulums[static_cast<std::size_t>(rods - 2)]][stepper];
    for (const double ms : kStepsMs) errors.push_back(energy_error(stepper, rods, ms * 1e-3));
  }
}

}  // namespace kaz::dynamics_table
