// World on the Open Dynamics Engine, double precision.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/ode/ode_world.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "sim/body/contact/contact_surface.h"

namespace kaz::sim {
namespace {

// Settings with which the gait was found (docs/reference/robot.md, "Dynamics").
constexpr double kErp = 0.2;
constexpr double kCfm = 1e-8;
constexpr double kQuickStepOverRelaxation = 1.3;
constexpr double kMotionToAlign = 1e-4;  // m/s
// Where bodies rest or fall together, contact rows are satisfied exactly without force. The exact LCP solver
// is then degenerate, fails ("LCP internal error, s <= 0") and applies no forces. Target separation
// velocities that differ from contact to contact, negligibly small, break the tie.
constexpr double kTieBreak = 1e-11;  // m/s

std::mutex& ode_mutex() {
  static std::mutex mutex;
  return mutex;
}

OdeWorldHandle make_world(const Eigen::Vector3d& gravity, int iterations) {
  enter_ode();
  OdeWorldHandle world(dWorldCreate());
  dWorldSetGravity(world.get(), gravity.x(), gravity.y(), gravity.z());
  dWorldSetERP(world.get(), kErp);
  dWorldSetCFM(world.get(), kCfm);
  dWorldSetContactSurfaceLayer(world.get(), kContactLayer);
  dWorldSetContactMaxCorrectingVel(world.get(), kContactMaxCorrection);
  if (iterations > 0) {
    dWorldSetQuickStepNumIterations(world.get(), iterations);
    dWorldSetQuickStepW(world.get(), kQuickStepOverRelaxation);
  }
  dWorldSetAutoDisableFlag(world.get(), 0);
  return world;
}

// ODE's parameters of a contact point. `motion`: velocity of a relative to b, m/s, world frame.
dContact contact_of(const Touch& touch, const Eigen::Vector3d& motion, double min_softness,
                    double step_s) {
  dContact contact{};
  const Surface& surface = touch.surface;
  contact.surface.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM;
  contact.surface.mu = surface.mu;
  contact.surface.soft_erp = erp_for(step_s, kContactErp);
  contact.surface.soft_cfm =
      softness_for(step_s, kContactErp, std::max(surface.softness, min_softness));
  for (int k = 0; k < 3; ++k) {
    contact.geom.pos[k] = touch.at[k];
    contact.geom.normal[k] = touch.normal[k];
  }
  contact.geom.depth = touch.depth;
  if (surface.restitution > 0) {
    contact.surface.mode |= dContactBounce;
    contact.surface.bounce = surface.restitution;
    contact.surface.bounce_vel = surface.bounce_threshold;
  }
  if (surface.rolling_resistance <= 0) return contact;
  contact.surface.mode |= dContactRolling;
  contact.surface.rho = surface.rolling_resistance;
  contact.surface.rho2 = surface.rolling_resistance;
  contact.surface.rhoN = surface.rolling_resistance;
  // ODE bounds the friction along each axis separately. The first axis is aligned with the motion, else a
  // rolling body would follow a curve.
  if (motion.norm() > kMotionToAlign) {
    contact.surface.mode |= dContactFDir1;
    Eigen::Vector3d along = motion - touch.normal * touch.normal.dot(motion);
    if (along.norm() < kMotionToAlign) along = touch.normal.unitOrthogonal();
    along.normalize();
    for (int k = 0; k < 3; ++k) contact.fdir1[k] = along[k];
  }
  return contact;
}

// Tangential contact compliance: a spring for the shear s (m, of a relative to b, world frame) as a target
// velocity -ERP s / step along two tangents, with the softness as slip. If a is static, ODE takes b as the
// first body and inverts the normal, so the signs change.
void add_shear(dContact& contact, const Touch& touch, const Eigen::Vector3d& shear, double step_s) {
  const double side = touch.body_a < 0 ? -1 : 1;
  const Eigen::Vector3d along = touch.normal.unitOrthogonal();
  const Eigen::Vector3d across = side * touch.normal.cross(along);
  const double rate = side * erp_for(step_s, kContactErp) / step_s;
  contact.surface.mode |=
      dContactFDir1 | dContactMotion1 | dContactMotion2 | dContactSlip1 | dContactSlip2;
  contact.surface.motion1 = -rate * along.dot(shear);
  contact.surface.motion2 = -rate * across.dot(shear);
  contact.surface.slip1 = contact.surface.slip2 =
      softness_for(step_s, kContactErp, touch.surface.softness);
  for (int k = 0; k < 3; ++k) contact.fdir1[k] = along[k];
}

Eigen::Vector3d velocity_of(dBodyID body) {
  return body ? to_eigen(dBodyGetLinearVel(body)) : Eigen::Vector3d::Zero().eval();
}

}  // namespace

OdeWorld::OdeWorld(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
                   const WorldOptions& options, int iterations)
    : StagedWorld(world, robot, motor, options),
      iterations_(iterations),
      // The seed folded to the 32 bits of ODE's generator.
      random_state_((options.seed ^ (options.seed >> 32)) & 0xffffffffu),
      ode_(make_world(world.gravity, iterations)),
      contact_rows_(dJointGroupCreate(0)),
      ode_joints_(robot.joints.size()) {
  for (std::size_t i = 0; i < ode_joints_.size(); ++i) {
    const RobotJoint& from = robot.joints[i];
    const RobotLink& child = robot.links[static_cast<std::size_t>(from.child)];
    Joint& joint = ode_joints_[i];
    joint.link = from.child;
    joint.parent = child.parent;
    joint.axis = child.at_zero.linear().transpose() * from.axis;
    joint.lower = from.lower - kStopMargin;
    joint.upper = from.upper + kStopMargin;
  }
  build();
  read_joints();
  read_imu(imu_velocity());
  read_motors();
}

// ODE's objects cannot be copied: they are built as at the start, then take over the state.
OdeWorld::OdeWorld(const OdeWorld& other)
    : StagedWorld(other),
      iterations_(other.iterations_),
      random_state_(other.random_state_),
      ode_(make_world(gravity_, iterations_)),
      contact_rows_(dJointGroupCreate(0)),
      ode_joints_(other.ode_joints_),
      memory_(other.memory_),
      watch_(other.watch_),
      watched_(other.watched_),
      largest_gap_(other.largest_gap_) {
  build();
  OdeWorld::watch_loads(watch_loads_);
  sleep_.continue_from(other.sleep_);
  copy_bodies(other);
}

// Bodies and joints at their start.
void OdeWorld::build() {
  threading_.reset(dThreadingAllocateSelfThreadedImplementation());
  dWorldSetStepThreadingImplementation(
      ode_.get(), dThreadingImplementationGetFunctions(threading_.get()), threading_.get());
  make_bodies();
  for (Joint& joint : ode_joints_) build_joint(joint);
  for (const WorldJoint& joint : model_->joints) build_passive_joint(joint);
  if (hung_) hang();
}

OdeWorld::~OdeWorld() = default;

void OdeWorld::make_bodies() {
  for (std::size_t number = 0; number < bodies().size(); ++number) {
    const Body& body = bodies()[number];
    ode_bodies_.push_back(body.moves ? dBodyCreate(ode_.get()) : nullptr);
    if (!body.moves) continue;
    const dBodyID id = ode_bodies_.back();
    dMass mass;
    const Eigen::Matrix3d& i = body.rigid.inertia;
    dMassSetParameters(&mass, body.rigid.mass, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2),
                       i(1, 2));
    dBodySetMass(id, &mass);
    const Eigen::Vector3d at = body.start * body.rigid.com;
    dBodySetPosition(id, at.x(), at.y(), at.z());
    dMatrix3 rotation;
    to_ode(body.start.linear(), rotation);
    dBodySetRotation(id, rotation);
    if (number >= robot_links_ && !model_->has_joint(static_cast<int>(number))) sleep_.add(id);
  }
}

// Fixes the root link to the world. Bodies are in the order of the links, the root's first.
void OdeWorld::hang() {
  const dJointID hook = dJointCreateFixed(ode_.get(), nullptr);
  dJointAttach(hook, ode_bodies_.front(), nullptr);
  dJointSetFixed(hook);
}

void OdeWorld::build_joint(Joint& out) {
  out.child = body(out.link);
  const dBodyID parent = body(out.parent);
  const Eigen::Isometry3d& start = bodies()[static_cast<std::size_t>(out.link)].start;
  const Eigen::Vector3d anchor = start.translation();
  const Eigen::Vector3d axis = start.linear() * out.axis;

  out.hinge = dJointCreateHinge(ode_.get(), nullptr);
  dJointAttach(out.hinge, out.child, parent);
  dJointSetHingeAnchor(out.hinge, anchor.x(), anchor.y(), anchor.z());
  dJointSetHingeAxis(out.hinge, axis.x(), axis.y(), axis.z());
  dJointSetHingeParam(out.hinge, dParamHiStop, out.upper);
  dJointSetHingeParam(out.hinge, dParamLoStop, out.lower);
  dJointSetHingeParam(out.hinge, dParamStopERP, erp_for(step_s_, kStopErp));
  dJointSetHingeParam(out.hinge, dParamStopCFM, softness_for(step_s_, kStopErp, kStopSoftness));

  // The motor is a separate constraint: at a stop ODE replaces a hinge's own motor by the stop's row,
  // which is without force limit.
  out.motor = dJointCreateAMotor(ode_.get(), nullptr);
  dJointAttach(out.motor, out.child, parent);
  dJointSetAMotorMode(out.motor, dAMotorUser);
  dJointSetAMotorNumAxes(out.motor, 1);
  dJointSetAMotorAxis(out.motor, 0, 1, axis.x(), axis.y(), axis.z());
  dJointSetFeedback(out.motor, &out.feedback);
}

void OdeWorld::kick(int number, const Eigen::Vector3d& velocity, const Eigen::Vector3d& spin) {
  const Eigen::Vector3d v = velocity_of(body(number)) + velocity;
  const Eigen::Vector3d w = to_eigen(dBodyGetAngularVel(body(number))) + spin;
  sleep_.wake(body(number));
  dBodySetLinearVel(body(number), v.x(), v.y(), v.z());
  dBodySetAngularVel(body(number), w.x(), w.y(), w.z());
}

int OdeWorld::find_contacts() {
  Contacts& contacts = Contacts::of_this_thread();
  find_contacts(contacts);
  return static_cast<int>(contacts.touches().size());
}

void OdeWorld::find_contacts(Contacts& contacts) const {
  contacts.begin(model_->contacts);
  for (std::size_t i = 0; i < ode_bodies_.size(); ++i) {
    const dBodyID id = ode_bodies_[i];
    if (id == nullptr) continue;
    contacts.place(static_cast<int>(i), rotation_to_eigen(dBodyGetRotation(id)),
                   to_eigen(dBodyGetPosition(id)), dBodyIsEnabled(id) != 0);
  }
  contacts.update();
}

// Replaces the contact rows of the previous step.
void OdeWorld::make_contact_rows(const Contacts& contacts) {
  dJointGroupEmpty(contact_rows_.get());
  watched_.clear();
  const std::span<const Touch> touches = contacts.touches();
  memory_.recall(touches);
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const Touch& touch = touches[i];
    const dBodyID a = body(touch.body_a), b = body(touch.body_b);
    dContact contact =
        contact_of(touch, velocity_of(a) - velocity_of(b), dWorldGetCFM(ode_.get()), step_s_);
    if (ContactMemory::has_shear(touch)) add_shear(contact, touch, memory_.shear(i), step_s_);
    if (iterations_ == 0) {
      contact.surface.mode |= dContactMotionN;
      contact.surface.motionN = kTieBreak * static_cast<double>(i + 1);
    }
    const dJointID row = dJointCreateContact(ode_.get(), contact_rows_.get(), &contact);
    dJointAttach(row, a, b);
    watched_.push_back({touch, {}});
    dJointSetFeedback(row, &watched_.back().feedback);
  }
}

void OdeWorld::remember_contacts() {
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const Touch& touch = watched_[i].touch;
    if (!ContactMemory::has_shear(touch)) continue;
    const auto velocity = [&](int number) -> Eigen::Vector3d {
      const dBodyID id = body(number);
      if (id == nullptr) return Eigen::Vector3d::Zero();
      const Eigen::Vector3d arm = touch.at - to_eigen(dBodyGetPosition(id));
      return velocity_of(id) + to_eigen(dBodyGetAngularVel(id)).cross(arm);
    };
    const double normal =
        (touch.body_a < 0 ? -1 : 1) * touch.normal.dot(to_eigen(watched_[i].feedback.f1));
    memory_.remember(i, velocity(touch.body_a) - velocity(touch.body_b), normal, step_s_);
  }
}

std::vector<ContactPoint> OdeWorld::contacts() const {
  std::vector<ContactPoint> points;
  if (!watch_) return points;
  points.reserve(watched_.size());
  for (const Watched& row : watched_) {
    const Eigen::Vector3d force = to_eigen(row.feedback.f1);
    // If a is static, the feedback is that of b.
    points.push_back({model_->contacts.name(row.touch.shape_a),
                      model_->contacts.name(row.touch.shape_b), row.touch.at,
                      row.touch.body_a < 0 ? Eigen::Vector3d(-force) : force});
  }
  return points;
}

// A motor that presses its joint against a stop is applied as a torque, Nm, instead of a row: the iterative
// solver converges slowly for two rows about one axis of which one is rigid, and the joint would jitter by
// several rad/s.
void OdeWorld::drive(std::size_t number) {
  Joint& joint = ode_joints_[number];
  const JointMotor::Row& row = rows_[number];
  const double angle = joint_states_[number].angle;
  const double presses = motors_[number].pressing(row);
  joint.pressing.reset();
  if ((angle <= joint.lower && presses < 0) || (angle >= joint.upper && presses > 0)) {
    joint.pressing = presses;
    dJointAddAMotorTorques(joint.motor, presses, 0, 0);
    set_row(joint.motor, {});
    return;
  }
  set_row(joint.motor, row);
}

// Writes a row to an ODE motor. ODE's motors act in both directions, so a one-sided row becomes a stop.
// A stop's target velocity is ERP * violation / step, and its ERP may be negative.
void OdeWorld::set_row(dJointID motor, const JointMotor::Row& row) const {
  const bool low = row.min == 0 && row.max > 0, high = row.max == 0 && row.min < 0;
  dJointSetAMotorParam(motor, dParamLoStop, low ? 0 : -dInfinity);
  dJointSetAMotorParam(motor, dParamHiStop, high ? 0 : dInfinity);
  if (!low && !high) {
    dJointSetAMotorParam(motor, dParamVel, row.velocity);
    dJointSetAMotorParam(motor, dParamCFM, row.softness);
    dJointSetAMotorParam(motor, dParamFMax, row.max);
    return;
  }
  dJointSetAMotorParam(motor, dParamFMax, 0);
  const double side = low ? 1.0 : -1.0;
  dJointSetAMotorAngle(motor, 0, -side * step_s_ * std::abs(row.velocity));
  dJointSetAMotorParam(motor, dParamStopERP, std::copysign(1.0, side * row.velocity));
  dJointSetAMotorParam(motor, dParamStopCFM, row.softness);
}

// One step by the exact solver, or by QuickStep with this world's state of ODE's global generator.
void OdeWorld::solve() {
  if (iterations_ == 0) {
    dWorldStep(ode_.get(), step_s_);
    return;
  }
  const std::lock_guard<std::mutex> lock(ode_mutex());
  const unsigned long others = dRandGetSeed();
  dRandSetSeed(random_state_);
  dWorldQuickStep(ode_.get(), step_s_);
  random_state_ = dRandGetSeed();
  dRandSetSeed(others);
}

// Checks the velocities of the step just done: ODE integrates positions in the same call, so they cannot be
// checked before.
void OdeWorld::check_solver() {
  for (std::size_t i = 0; i < joint_states_.size(); ++i) {
    if (!joint_can_turn(model_->joint_order[i], joint_states_[i].velocity)) return;
  }
  for (std::size_t i = 0; i < bodies().size(); ++i) {
    const dBodyID id = body(static_cast<int>(i));
    if (bodies()[i].moves && id != nullptr &&
        !body_can_move(i, to_eigen(dBodyGetLinearVel(id)), to_eigen(dBodyGetAngularVel(id))))
      return;
  }
}

void OdeWorld::step(std::span<const MotorDrive> drives, double supply_volts) {
  if (!diagnostics_.failure.empty()) return;
  enter_ode();
  kick_due();
  Contacts& contacts = Contacts::of_this_thread();
  find_contacts(contacts);
  make_contact_rows(contacts);
  prepare_motors(drives, supply_volts);
  if (!drives_are_numbers()) return;
  for (std::size_t i = 0; i < rows_.size(); ++i) drive(i);
  sleep_.update(step_s_);
  for (const HandPush& push : hand_pushes_) {
    const Eigen::Vector3d force = push.impulse / step_s_;
    dBodyAddForce(body(static_cast<int>(push.link)), force.x(), force.y(), force.z());
  }
  hand_pushes_.clear();
  const Eigen::Vector3d velocity_before = imu_velocity();
  keep_frames();
  solve();
  remember_contacts();
  ++steps_;
  read_joints();
  measure_forces();
  read_imu(velocity_before);
  finish_motors();
  check_solver();
}

void OdeWorld::read_joints() {
  for (std::size_t i = 0; i < ode_joints_.size(); ++i) {
    Joint& joint = ode_joints_[i];
    JointState& state = joint_states_[i];
    state.angle = dJointGetHingeAngle(joint.hinge);
    state.velocity = dJointGetHingeAngleRate(joint.hinge);
    const Eigen::Vector3d axis = rotation_to_eigen(dBodyGetRotation(joint.child)) * joint.axis;
    state.torque = joint.pressing.value_or(axis.dot(to_eigen(joint.feedback.t1)));
    dVector3 a, b;
    dJointGetHingeAnchor(joint.hinge, a);
    dJointGetHingeAnchor2(joint.hinge, b);
    largest_gap_ = std::max(largest_gap_, (to_eigen(a) - to_eigen(b)).norm());
  }
}

// Velocity of the IMU's origin, m/s, world frame: v = v_com + w x (p - p_com).
Eigen::Vector3d OdeWorld::imu_velocity() const {
  const dBodyID id = body(imu_frame_.link);
  if (id == nullptr) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d& com = bodies()[static_cast<std::size_t>(imu_frame_.link)].rigid.com;
  const Eigen::Vector3d arm =
      rotation_to_eigen(dBodyGetRotation(id)) * (imu_frame_.in_link.translation() - com);
  return to_eigen(dBodyGetLinearVel(id)) + to_eigen(dBodyGetAngularVel(id)).cross(arm);
}

// Ideal IMU in its own frame: angular velocity, rad/s, and specific force f = (v - v_before) / step - g,
// m/s^2.
void OdeWorld::read_imu(const Eigen::Vector3d& velocity_before) {
  const dBodyID id = body(imu_frame_.link);
  const Eigen::Matrix3d to_sensor =
      (body_pose(imu_frame_.link).linear() * imu_frame_.in_link.linear()).transpose();
  if (id != nullptr) imu_.angular_velocity = to_sensor * to_eigen(dBodyGetAngularVel(id));
  imu_.specific_force = to_sensor * ((imu_velocity() - velocity_before) / step_s_ - gravity_);
}

Eigen::Isometry3d OdeWorld::moving_pose(int number) const {
  const dBodyID id = body(number);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_to_eigen(dBodyGetRotation(id));
  pose.translation() = to_eigen(dBodyGetPosition(id)) -
                       pose.linear() * bodies()[static_cast<std::size_t>(number)].rigid.com;
  return pose;
}

std::string OdeWorld::dynamics() const {
  return iterations_ == 0 ? "exact" : "quick" + std::to_string(iterations_);
}

}  // namespace kaz::sim
