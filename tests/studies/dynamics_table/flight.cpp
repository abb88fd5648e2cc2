// Free flight without gravity: a tumbling rigid body, and Kaz tumbling while its motors run.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/body/reduced/reduced_world.h"
#include "tests/studies/dynamics_table/scene.h"

namespace kaz::dynamics_table {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Two links on a jammed joint, so that two pushes can set it spinning. The joint yields by 1e-6 rad/Nm
// (joint_motor.h), which is negligible here.
sim::RobotModel tumbler() {
  sim::RobotModel robot;
  robot.name = "tumbler";
  sim::RigidLink body;
  body.name = "body";
  body.mass = 0.2;
  body.inertia = Vector3d(1.2e-4, 2.6e-4, 2.9e-4).asDiagonal();
  sim::RigidLink handle;
  handle.name = "handle";
  handle.mass = 0.02;
  handle.com = {0.01, 0, 0.02};
  handle.inertia = Vector3d(2e-6, 3e-6, 2.5e-6).asDiagonal();
  sim::test::add_link(robot, body, Vector3d::Zero(), Vector3d::UnitX(), 0, 0);
  sim::test::add_link(robot, handle, {0.03, 0, 0.02}, Vector3d::UnitX(), -1, 1);
  return robot;
}

// About the whole's centre of mass, axes of the root at the zero posture.
Matrix3d inertia_of(const sim::RobotModel& robot) {
  Vector3d centre = Vector3d::Zero();
  for (const sim::RobotLink& link : robot.links)
    centre += link.rigid.mass / robot.mass() * (link.at_zero * link.rigid.com);
  Matrix3d sum = Matrix3d::Zero();
  for (const sim::RobotLink& link : robot.links) {
    const Vector3d arm = link.at_zero * link.rigid.com - centre;
    const Matrix3d turn = link.at_zero.linear();
    sum += turn * link.rigid.inertia * turn.transpose() +
           link.rigid.mass * (arm.squaredNorm() * Matrix3d::Identity() - arm * arm.transpose());
  }
  return sum;
}

// Euler's equations by classical fourth-order Runge-Kutta in steps of 20 us: error below 1e-11 here.
struct Euler {
  Matrix3d inertia;
  Quaterniond turn;
  Vector3d spin;  // own axes, rad/s

  void run(double seconds) {
    constexpr double h = 2e-5;
    const Matrix3d inverse = inertia.inverse();
    const auto faster = [&](const Vector3d& w) {
      return Vector3d(inverse * (inertia * w).cross(w));
    };
    const auto turning = [](const Quaterniond& q, const Vector3d& w) {
      return Eigen::Vector4d(0.5 * (q * Quaterniond(0, w.x(), w.y(), w.z())).coeffs());
    };
    const auto moved = [](const Quaterniond& q, const Eigen::Vector4d& by) {
      return Quaterniond(Eigen::Vector4d(q.coeffs() + by));
    };
    for (long i = std::lround(seconds / h); i > 0; --i) {
      const Vector3d a1 = faster(spin), w2 = spin + h / 2 * a1, a2 = faster(w2);
      const Vector3d w3 = spin + h / 2 * a2, a3 = faster(w3), w4 = spin + h * a3;
      const Eigen::Vector4d q1 = turning(turn, spin), q2 = turning(moved(turn, h / 2 * q1), w2);
      const Eigen::Vector4d q3 = turning(moved(turn, h / 2 * q2), w3);
      const Eigen::Vector4d q4 = turning(moved(turn, h * q3), w4);
      turn = moved(turn, h / 6 * (q1 + 2 * q2 + 2 * q3 + q4)).normalized();
      spin += h / 6 * (a1 + 2 * a2 + 2 * a3 + faster(w4));
    }
  }
};

void tumble(const std::string& stepper, Table& table) {
  const sim::RobotModel robot = tumbler();
  const Matrix3d inertia = inertia_of(robot);
  sim::WorldModel space;
  space.gravity.setZero();
  const auto world = world_of(stepper, space, robot, sim::test::free_motor());
  const std::array jammed{sim::MotorDrive{.duty = 0, .powered = true, .jammed = true}};
  world->step(jammed, kVolts);
  // About 12 rad/s, mostly about the intermediate axis, which is unstable: it flips repeatedly.
  const Vector3d push = {-0.05, 0.006, 0.05};
  static_cast<void>(world->push("body", -push));
  static_cast<void>(world->push("handle", push));
  run(*world, 0.002, jammed);

  const auto turn = [&] { return Matrix3d(world->link_pose("body").linear()); };
  const auto spin = [&] { return world->imu().angular_velocity; };  // own axes, end of the step
  // Computed by `reduced` for both links; else of a rigid body with the measured attitude and rate.
  const auto momentum_now = [&]() -> Vector3d {
    if (const auto* reduced = dynamic_cast<const sim::ReducedWorld*>(world.get())) {
      sim::ArticulatedTree tree = reduced->tree();
      return tree.momentum().angular;
    }
    return turn() * inertia * spin();
  };
  const Vector3d momentum = momentum_now();
  const double energy = spin().dot(inertia * spin());
  Euler reference{inertia, Quaterniond(turn()), spin()};
  const double rate = spin().norm();
  double lost = 0, off = 0, after_1_s = 0, flipped = 1;
  const Vector3d start = turn().col(1);
  for (int i = 1; i <= 10'000; ++i) {
    world->step(jammed, kVolts);
    lost = std::max(lost, (momentum_now() - momentum).norm() / momentum.norm());
    const double now = spin().dot(inertia * spin()) / energy - 1;
    if (std::abs(now) > std::abs(off)) off = now;
    flipped = std::min(flipped, turn().col(1).dot(start));
    if (i != 1000) continue;
    reference.run(1.0);
    after_1_s = reference.turn.angularDistance(Quaterniond(turn()));
  }
  reference.run(9.0);
  const std::string scene = value("rigid body, torque-free, %.0f rad/s", rate);
  table.put(stepper, scene, "angular momentum, 10 s", "constant", "", lost);
  table.put(stepper, scene, "energy, 10 s", "constant", "", off);
  table.put(stepper, scene, "attitude after 1 s", "Euler's equations", "rad", after_1_s);
  table.put(stepper, scene, "attitude after 10 s", "Euler's equations", "rad",
            reference.turn.angularDistance(Quaterniond(turn())));
}

class Flyer {
 public:
  explicit Flyer(const std::string& stepper) : robot_(sim::load_robot(KAZ_ROBOT).value()) {
    sim::WorldModel space;
    space.gravity.setZero();
    world_ = world_of(stepper, space, robot_, sim::load_motor_file(KAZ_MOTOR, "").value());
    before_ = now_ = poses();
  }
  sim::StagedWorld& world() { return *world_; }
  void step() {
    std::array<sim::MotorDrive, KZ_JOINTS> drives;
    for (std::size_t j = 0; j < drives.size(); ++j) {
      const double target = 0.4 * std::sin(6 * world_->time_s() + static_cast<double>(j));
      const sim::JointState& joint = world_->joints()[j];
      drives[j] = {10 * (target - joint.angle) - 0.15 * joint.velocity, true};
    }
    before_ = now_;
    world_->step(drives, kVolts);
    now_ = poses();
  }
  Vector3d centre() const {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < now_.size(); ++i)
      sum += robot_.links[i].rigid.mass * (now_[i] * robot_.links[i].rigid.com);
    return sum / robot_.mass();
  }
  // About the centre of mass, kg m2/s: computed by `reduced`, else from differences over the step.
  Vector3d momentum() const {
    if (const auto* reduced = dynamic_cast<const sim::ReducedWorld*>(world_.get())) {
      sim::ArticulatedTree tree = reduced->tree();
      return tree.momentum().angular;
    }
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < now_.size(); ++i) {
      const sim::RigidLink& link = robot_.links[i].rigid;
      const Vector3d at = now_[i] * link.com, was = before_[i] * link.com;
      const Eigen::AngleAxisd turn(now_[i].linear() * before_[i].linear().transpose());
      sum += link.mass * (at - centre()).cross((at - was) / kStep) +
             now_[i].linear() * link.inertia * now_[i].linear().transpose() * turn.axis() *
                 (turn.angle() / kStep);
    }
    return sum;
  }

 private:
  std::vector<Eigen::Isometry3d> poses() const {
    std::vector<Eigen::Isometry3d> all;
    for (const sim::RobotLink& link : robot_.links)
      all.push_back(world_->link_pose(link.rigid.name));
    return all;
  }
  sim::RobotModel robot_;
  std::unique_ptr<sim::StagedWorld> world_;
  std::vector<Eigen::Isometry3d> before_, now_;
};

void tumble_kaz(const std::string& stepper, Table& table) {
  Flyer kaz(stepper);
  static_cast<void>(kaz.world().push("l_ankle_pitch", {0.10, 0.03, 0}));
  static_cast<void>(kaz.world().push("neck_tilt", {-0.10, -0.03, 0}));
  kaz.step();
  kaz.step();
  const Vector3d momentum = kaz.momentum(), centre = kaz.centre();
  double lost = 0, moved = 0;
  for (int i = 0; i < 3000; ++i) {
    kaz.step();
    lost = std::max(lost, (kaz.momentum() - momentum).norm() / momentum.norm());
    moved = std::max(moved, (kaz.centre() - centre).norm());
  }
  const std::string scene = value("Kaz tumbles, all motors running, %.3f kg m²/s", momentum.norm());
  table.put(stepper, scene, "angular momentum, 3 s", "constant", "", lost);
  table.put(stepper, scene, "centre of mass, 3 s", "at rest", "m", moved);
  table.put(stepper, scene, "gap in a joint, 3 s", "none", "m", kaz.world().largest_joint_gap_m());
}

}  // namespace

void fly(const std::string& stepper, Table& table) {
  tumble(stepper, table);
  tumble_kaz(stepper, table);
}

}  // namespace kaz::dynamics_table
