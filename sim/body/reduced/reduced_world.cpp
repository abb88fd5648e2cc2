// World in reduced coordinates: one step.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/reduced/reduced_world.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kaz::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Tolerance of Newton's method: largest velocity change in the last iteration, m/s or rad/s.
constexpr double kExact = 1e-8;
constexpr double kSettled =
    1e-6;                       // a step with a larger residual counts as unconverged, m/s or rad/s
constexpr int kMaxSteps = 300;  // iterations; a dozen are usual

}  // namespace

ReducedWorld::ReducedWorld(const WorldModel& world, const RobotModel& robot,
                           const MotorParams& motor, const WorldOptions& options)
    : StagedWorld(world, robot, motor, options),
      tree_(robot, bodies().front().start, hung_),
      layout_(std::make_shared<const Layout>(layout_of(robot, tree_))),
      velocity_before_(static_cast<std::size_t>(tree_.dofs()), 0.0) {
  for (std::size_t i = robot_links_; i < bodies().size(); ++i)
    objects_.emplace_back(bodies()[i].rigid, bodies()[i].start);
  add_passive_joints();
  for (const Follower& follower : layout_->followers)
    tree_.angle[tree_.index_of_dof(follower.dof)] = follower.offset;
  if (!layout_->followers.empty()) tree_.place();
  read_joints();
  read_imu(imu_velocity());
  read_motors();
}

ReducedWorld::Layout ReducedWorld::layout_of(const RobotModel& robot, const ArticulatedTree& tree) {
  Layout layout;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const RobotJoint& joint = robot.joints[i];
    const int dof = tree.dof_of_joint(static_cast<int>(i));
    layout.joints.push_back(
        {joint.name, dof, joint.lower - kStopMargin, joint.upper + kStopMargin});
    if (const auto& follows = joint.follows)
      layout.followers.push_back(
          {dof, tree.dof_of_joint(follows->joint), follows->ratio, follows->offset});
  }
  layout.chains = chains_of(tree);
  return layout;
}

ReducedWorld::Work& ReducedWorld::Work::of_this_thread(const ReducedWorld& world) {
  thread_local Work work;
  const auto dofs = static_cast<std::size_t>(world.tree_.dofs());
  for (std::vector<double>* v : {&work.bias, &work.halfway, &work.acceleration}) v->resize(dofs);
  work.coordinate_of.resize(world.objects_.size());
  work.outer.resize(world.robot_links_);
  return work;
}

int ReducedWorld::find_contacts() {
  Contacts& contacts = Contacts::of_this_thread();
  find_contacts(contacts);
  return static_cast<int>(contacts.touches().size());
}

void ReducedWorld::find_contacts(Contacts& contacts) const {
  contacts.begin(model_->contacts);
  for (std::size_t i = 0; i < bodies().size(); ++i) {
    const int body = static_cast<int>(i);
    if (!bodies()[i].moves) continue;
    if (i < robot_links_) {
      contacts.place(body, tree_.axes(body), tree_.com(body), true);
    } else {
      const FreeBody& free = object(body);
      contacts.place(body, free.axes(), free.com, free.awake);
    }
  }
  contacts.update();
}

// The rule of BodySleep: a body at rest for long enough sleeps until a body that is awake touches it.
void ReducedWorld::settle_sleep(Work& work) {
  constexpr SleepRule rule;
  const std::span<const Touch> touches = work.contacts.touches();
  const auto touched = [&](std::size_t i) {
    const int body = static_cast<int>(i + robot_links_);
    return std::ranges::any_of(touches, [body](const Touch& touch) {
      return touch.body_a == body || touch.body_b == body;
    });
  };
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    FreeBody& body = objects_[i];
    if (layout_->jointed[i]) body.awake = true;
    if (!body.awake || layout_->jointed[i] || !touched(i)) continue;
    if (body.velocity.squaredNorm() > rule.linear * rule.linear ||
        body.angular_velocity().squaredNorm() > rule.angular * rule.angular) {
      body.left_s = rule.after_s;
      continue;
    }
    body.left_s -= step_s_;
    if (body.left_s > 0) continue;
    body.awake = false;
    body.stop();
  }
  const auto awake = [this](int body) {
    return body >= 0 && (of_robot(body) || object(body).awake);
  };
  for (bool again = true; again;) {
    again = false;
    for (const Touch& touch : touches) {
      if (awake(touch.body_a) == awake(touch.body_b)) continue;
      const int other = awake(touch.body_a) ? touch.body_b : touch.body_a;
      if (other < 0) continue;
      object(other).awake = true;
      again = true;
    }
  }
}

void ReducedWorld::run_solver(Work& work) {
  work.solver.solve(work.momentum, work.velocity, kExact, kMaxSteps);
  effort_ = {work.solver.steps(), work.solver.residual()};
  if (work.solver.residual() <= kSettled) return;
  if (diagnostics_.unconverged_steps++ == 0) diagnostics_.first_s = time_s();
  diagnostics_.last_s = time_s();
  diagnostics_.max_residual = std::max(diagnostics_.max_residual, work.solver.residual());
  diagnostics_.drift += work.solver.residual() * step_s_;
}

void ReducedWorld::solve(Work& work) {
  strike(work);
  begin_rows(work);
  shear_.recall(work.contacts.touches());
  for (std::size_t i = 0; i < work.contacts.touches().size(); ++i) make_contact_row(work, i);
  make_joint_rows(work);
  make_coupling_rows(work);
  make_passive_rows(work);
  work.solver.close();
  write_momentum(work);
  velocity_before_ = tree_.velocity;
  run_solver(work);
}

// Explicit position update q += seconds v with the tree's velocities, which it does not change.
void ReducedWorld::move_tree(double seconds) {
  const std::vector<double>& v = tree_.velocity;
  if (tree_.root_dofs() > 0) {
    tree_.root_at += seconds * Vector3d(v[3], v[4], v[5]);
    tree_.root_turn = turned(tree_.root_turn, seconds * Vector3d(v[0], v[1], v[2]));
  }
  for (const Joint& joint : layout_->joints) {
    const auto dof = static_cast<std::size_t>(joint.dof);
    tree_.angle[tree_.index_of_dof(joint.dof)] += seconds * v[dof];
  }
  tree_.place();
  tree_.velocities();
}

// Position update in flight, second order: the root's velocity follows from momentum conservation at the
// midpoint of the joints' motion. The centre of mass moves by h (p_new - h m g / 2) / m, exactly.
void ReducedWorld::fly(const ArticulatedTree::Momentum& after, const Vector3d& centre) {
  const Vector3d at = tree_.root_at;
  const Eigen::Quaterniond turn = tree_.root_turn;
  const Vector3d mean = after.linear - step_s_ / 2 * tree_.mass() * gravity_;
  move_tree(step_s_ / 2);
  tree_.set_momentum({mean, after.angular});
  tree_.root_at = at;
  tree_.root_turn = turn;
  // Back to the start of the step: the joints have already moved by half a step.
  for (const Joint& joint : layout_->joints) {
    const auto dof = static_cast<std::size_t>(joint.dof);
    tree_.angle[tree_.index_of_dof(joint.dof)] -= step_s_ / 2 * tree_.velocity[dof];
  }
  move_tree(step_s_);
  tree_.set_momentum(after);
  tree_.root_at += centre + step_s_ / tree_.mass() * mean - tree_.mass_centre();
}

void ReducedWorld::advance(Work& work) {
  ArticulatedTree::Momentum momentum = tree_.momentum();
  const Vector3d centre = tree_.mass_centre();
  bool robot_flies = true;
  work.flies.assign(objects_.size(), true);
  if (watch_) watched_.clear();
  memory_.clear();
  for (std::size_t i = 0; i < work.pushes.size(); ++i) {
    const Touch& touch = work.contacts.touches()[work.pushes[i].touch];
    const VelocitySolver::Impulse& l = work.solver.impulse(i);
    const Vector3d impulse = work.pushes[i].basis * l.head<3>();
    const Vector3d moment = work.pushes[i].basis * Vector3d(l[5], l[3], l[4]);
    if (ContactMemory::has_shear(touch)) {
      const VelocitySolver::Impulse& u = work.solver.velocity(i);
      shear_.remember(work.pushes[i].touch, work.pushes[i].basis * u.head<3>(), l[0] / step_s_,
                      step_s_);
    }
    if (l[0] > 0) memory_.push_back({touch.shape_a, touch.shape_b, touch.at, impulse, moment});
    const bool leaves = l[0] <= 0 && touch.surface.restitution > 0;
    for (const auto& [body, sign] : {std::pair{touch.body_a, 1.0}, {touch.body_b, -1.0}}) {
      if (body < 0 || leaves) continue;
      if (!of_robot(body)) {
        work.flies[static_cast<std::size_t>(body) - robot_links_] = false;
        continue;
      }
      // Contacts between its own links do not end a flight.
      robot_flies = robot_flies && of_robot(touch.body_a) && of_robot(touch.body_b);
      momentum.linear += sign * impulse;
      momentum.angular += sign * ((touch.at - centre).cross(impulse) + moment);
    }
    if (!watch_) continue;
    watched_.push_back({model_->contacts.name(touch.shape_a), model_->contacts.name(touch.shape_b),
                        touch.at,
                        work.pushes[i].basis * work.impulse(i).head<3>() / step_s_});
  }
  momentum.linear += step_s_ * tree_.mass() * gravity_;
  for (const HandPush& push : hand_pushes_) {
    momentum.linear += push.impulse;
    momentum.angular += (tree_.com(static_cast<int>(push.link)) - centre).cross(push.impulse);
  }
  hand_pushes_.clear();

  std::copy_n(work.velocity.begin(), tree_.velocity.size(), tree_.velocity.begin());
  if (robot_flies && tree_.root_dofs() > 0) {
    fly(momentum, centre);
  } else {
    move_tree(step_s_);
    tree_.set_momentum(momentum);
  }

  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (work.coordinate_of[i] < 0) continue;
    const double* v = work.velocity.data() + work.coordinate_of[i];
    objects_[i].advance({v[3], v[4], v[5]}, {v[0], v[1], v[2]},
                        work.flies[i] && !layout_->jointed[i], step_s_);
  }
  read_passive_joints();
}

// Checks the solution: finite, and no joint or body moves further than a step can follow.
bool ReducedWorld::can_move(const Work& work) {
  const std::vector<double>& v = work.velocity;
  if (!std::isfinite(work.solver.residual())) {
    break_down("the solver found no finite velocities");
    return false;
  }
  for (const Joint& joint : layout_->joints) {
    if (!joint_can_turn(joint.name, v[static_cast<std::size_t>(joint.dof)])) return false;
  }
  const auto six = [&](std::size_t body, const double* of) {
    return body_can_move(body, {of[3], of[4], of[5]}, {of[0], of[1], of[2]});
  };
  if (tree_.root_dofs() > 0 && !six(0, v.data())) return false;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (work.coordinate_of[i] >= 0 && !six(robot_links_ + i, v.data() + work.coordinate_of[i]))
      return false;
  }
  return true;
}

void ReducedWorld::step(std::span<const MotorDrive> drives, double supply_volts) {
  if (!diagnostics_.failure.empty()) return;
  Work& work = Work::of_this_thread(*this);
  kick_due();
  find_contacts(work.contacts);
  prepare_motors(drives, supply_volts);
  if (!drives_are_numbers()) return;
  settle_sleep(work);
  const Vector3d velocity_before = imu_velocity();
  solve(work);
  if (!can_move(work)) return;
  for (std::size_t i = 0; i < joint_states_.size(); ++i)
    joint_states_[i].torque = work.solver.bounded(i) / step_s_;
  if (servo_) read_servo_torques(work);
  measure_forces(work);
  advance(work);
  ++steps_;
  read_joints();
  read_imu(velocity_before);
  finish_motors();
}

// Torques of the step: motor and friction together; and external = M (v_new - v_old) / h - torque, which has
// gravity, contacts and stops, but not the inertia of the links.
void ReducedWorld::read_servo_torques(Work& work) {
  work.change.assign(work.velocity.size(), 0.0);
  for (std::size_t i = 0; i < velocity_before_.size(); ++i)
    work.change[i] = work.velocity[i] - velocity_before_[i];
  work.solver.multiply(work.change.data(), work.momentum.data());
  for (std::size_t i = 0; i < joint_states_.size(); ++i) {
    joint_states_[i].torque += work.solver.bounded(rows_.size() + i) / step_s_;
    const double impulse = work.momentum[static_cast<std::size_t>(layout_->joints[i].dof)];
    external_nm_[i] = impulse / step_s_ - joint_states_[i].torque;
  }
}

void ReducedWorld::read_joints() {
  for (std::size_t i = 0; i < joint_states_.size(); ++i) {
    const int dof = layout_->joints[i].dof;
    JointState& state = joint_states_[i];
    state.angle = tree_.angle[tree_.index_of_dof(dof)];
    state.velocity = tree_.velocity[static_cast<std::size_t>(dof)];
  }
}

// Velocity of the sensor's origin, world axes, m/s.
Vector3d ReducedWorld::imu_velocity() const {
  const int link = imu_frame_.link;
  return tree_.velocity_at(
      link, tree_.origin(link) + tree_.axes(link) * imu_frame_.in_link.translation());
}

// Specific force = (v_new - v_old) / h - g in the sensor's axes, m/s^2.
void ReducedWorld::read_imu(const Vector3d& velocity_before) {
  const int link = imu_frame_.link;
  const Matrix3d to_sensor = (tree_.axes(link) * imu_frame_.in_link.linear()).transpose();
  imu_.angular_velocity = to_sensor * tree_.angular_velocity(link);
  imu_.specific_force = to_sensor * ((imu_velocity() - velocity_before) / step_s_ - gravity_);
}

void ReducedWorld::kick(int body, const Vector3d& velocity, const Vector3d& spin) {
  FreeBody& free = object(body);
  free.awake = true;
  free.left_s = SleepRule{}.after_s;
  free.strike(free.velocity + velocity, free.angular_velocity() + spin);
}

Eigen::Isometry3d ReducedWorld::moving_pose(int body) const {
  if (!of_robot(body)) return object(body).link_pose();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = tree_.axes(body);
  pose.translation() = tree_.origin(body);
  return pose;
}

std::vector<ContactPoint> ReducedWorld::contacts() const {
  return watch_ ? watched_ : std::vector<ContactPoint>{};
}

template <class A>
void ReducedWorld::transfer(A& a) {
  transfer_stage(a);
  if (!a.good()) return;
  for (int k = 0; k < 3; ++k) a(tree_.root_at[k]);
  for (int k = 0; k < 4; ++k) a(tree_.root_turn.coeffs()[k]);
  for (double& angle : tree_.angle) a(angle);
  for (double& velocity : tree_.velocity) a(velocity);
  for (double& velocity : velocity_before_) a(velocity);
  for (FreeBody& body : objects_) a(body);
  for (double& angle : passive_angle_) a(angle);
  a(memory_, shear_);
  const auto moves = [](double velocity) { return std::abs(velocity) < 1e7; };
  a.require(is_saved_place(tree_.root_at) && is_saved_turn(tree_.root_turn) &&
                std::ranges::all_of(tree_.angle, moves) &&
                std::ranges::all_of(tree_.velocity, moves),
            "robot pose");
  a.require(std::ranges::all_of(passive_angle_, moves), "passive joint");
  if constexpr (A::reading) {
    if (!a.good()) return;
    tree_.place();
    tree_.velocities();
  }
}

void ReducedWorld::save(StateWriter& to) {
  transfer(to);
}

void ReducedWorld::restore(StateReader& from) {
  transfer(from);
}

}  // namespace kaz::sim
