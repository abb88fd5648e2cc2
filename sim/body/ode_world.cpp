// World on the Open Dynamics Engine, double precision.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/ode_world.h"

#include <algorithm>
#include <cmath>
#include <mutex>

namespace kaz::sim {
namespace {

// Settings with which the gait was found (docs/robot.md, "Dynamics").
constexpr double kErp = 0.2;
constexpr double kCfm = 1e-8;
constexpr double kQuickStepOverRelaxation = 1.3;
constexpr double kContactLayer = 2e-4;         // m
constexpr double kContactMaxCorrection = 0.2;  // m/s
constexpr double kHungHeight = 0.5;            // m, of the feet above the ground
constexpr double kStopMargin = 0.0174533;      // rad, mechanical stop beyond the firmware's limit

// Objects lie still below these for a moment, and are then left out until something touches them.
constexpr double kSleepLinear = 0.003;  // m/s
constexpr double kSleepAngular = 0.15;  // rad/s
constexpr double kSleepAfter = 0.25;    // s

std::mutex& ode_mutex() {
  static std::mutex mutex;
  return mutex;
}

// ODE wants to be told of each thread that uses it.
void enter_ode() {
  static const int once = dInitODE2(0);
  thread_local const int thread = dAllocateODEDataForThread(dAllocateMaskAll);
  static_cast<void>(once);
  static_cast<void>(thread);
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

}  // namespace

OdeWorld::OdeWorld(const WorldModel& world, const RobotModel& robot, const MotorFigures& motor,
                   const WorldOptions& options, int iterations)
    : step_s_(options.step_s),
      iterations_(iterations),
      // ODE's generator has 32 bits.
      random_state_((options.seed ^ (options.seed >> 32)) & 0xffffffffu),
      ode_(make_world(world.gravity, iterations)),
      contacts_(ode_.get(), robot),
      sleep_({kSleepLinear, kSleepAngular, kSleepAfter}),
      motors_(robot.joints.size(), JointMotor(motor, options.step_s)),
      joint_order_(robot.joint_order()),
      ode_joints_(robot.joints.size()),
      joint_states_(robot.joints.size()) {
  scene_.frames.push_back("world");
  // The root's origin hangs above the point between the soles.
  const double feet = options.hung ? kHungHeight : 0.0;
  const Eigen::AlignedBox3d extent = robot.extent();
  Eigen::Vector3d lift = Eigen::Vector3d::Zero();
  if (!robot.fixed_base) lift.z() = feet - (extent.isEmpty() ? 0.0 : extent.min().z());
  build_robot(robot, world.robot_start * Eigen::Translation3d(lift));
  if (options.hung && !robot.fixed_base) hang();
  for (const WorldBody& object : world.bodies) build_object(object);
  // Latest first, so that the next one is taken from the end; equal times keep the order of the
  // file.
  std::reverse(kicks_.begin(), kicks_.end());
  std::stable_sort(kicks_.begin(), kicks_.end(),
                   [](const PendingKick& a, const PendingKick& b) { return a.step > b.step; });
  all_kicks_ = kicks_;
  read_joints();
  read_imu(imu_velocity());
  read_motors();
}

OdeWorld::~OdeWorld() = default;

OdeWorld::Body OdeWorld::make_body(const RigidLink& link, const Eigen::Isometry3d& pose) {
  Body body{dBodyCreate(ode_.get()), link.com, Eigen::Isometry3d::Identity()};
  dMass mass;
  const Eigen::Matrix3d& i = link.inertia;
  dMassSetParameters(&mass, link.mass, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2),
                     i(1, 2));
  dBodySetMass(body.id, &mass);
  const Eigen::Vector3d at = pose * link.com;
  dBodySetPosition(body.id, at.x(), at.y(), at.z());
  dMatrix3 rotation;
  to_ode(pose.linear(), rotation);
  dBodySetRotation(body.id, rotation);
  return body;
}

int OdeWorld::add_frame(const std::string& name, const Body& body) {
  frames_.push_back(body);
  scene_.frames.push_back(name);
  return static_cast<int>(scene_.frames.size()) - 1;
}

void OdeWorld::add_visuals(const RigidLink& link, int frame, const Eigen::Isometry3d& in_frame) {
  for (Visual visual : link.visuals) {
    visual.frame = frame;
    visual.in_frame = in_frame * visual.in_frame;
    scene_.visuals.push_back(std::move(visual));
  }
}

void OdeWorld::build_robot(const RobotModel& robot, const Eigen::Isometry3d& root) {
  link_frames_ = robot.frames;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const RobotLink& link = robot.links[i];
    const Eigen::Isometry3d at = root * link.at_zero;
    const bool moves = i > 0 || !robot.fixed_base;
    const Body body = moves ? make_body(link.rigid, at) : Body{nullptr, link.rigid.com, at};
    robot_bodies_.push_back(body);
    contacts_.add_robot_link(link.rigid, static_cast<int>(i), body.id, at);
    const int frame = add_frame(link.rigid.name, body);
    add_visuals(link.rigid, frame, Eigen::Isometry3d::Identity());
    if (robot.eyes_link() == static_cast<int>(i)) head_frame_ = frame;
  }
  for (std::size_t j = 0; j < robot.joints.size(); ++j) build_joint(robot, j, root);
  if (const auto imu = link_frames_.find("imu"); imu != link_frames_.end())
    imu_frame_ = imu->second;
}

// Bodies are in the order of the links, the root's first.
void OdeWorld::hang() {
  const dJointID hook = dJointCreateFixed(ode_.get(), nullptr);
  dJointAttach(hook, robot_bodies_.front().id, nullptr);
  dJointSetFixed(hook);
}

void OdeWorld::build_joint(const RobotModel& robot, std::size_t number,
                           const Eigen::Isometry3d& root) {
  const RobotJoint& joint = robot.joints[number];
  const RobotLink& link = robot.links[static_cast<std::size_t>(joint.child)];
  Joint& out = ode_joints_[number];
  out.child = robot_bodies_[static_cast<std::size_t>(joint.child)].id;
  const dBodyID parent = robot_bodies_[static_cast<std::size_t>(link.parent)].id;
  const Eigen::Vector3d anchor = root * link.at_zero.translation();
  const Eigen::Vector3d axis = root.linear() * joint.axis;
  out.axis = link.at_zero.linear().transpose() * joint.axis;

  out.hinge = dJointCreateHinge(ode_.get(), nullptr);
  dJointAttach(out.hinge, out.child, parent);
  dJointSetHingeAnchor(out.hinge, anchor.x(), anchor.y(), anchor.z());
  dJointSetHingeAxis(out.hinge, axis.x(), axis.y(), axis.z());
  dJointSetHingeParam(out.hinge, dParamHiStop, joint.upper + kStopMargin);
  dJointSetHingeParam(out.hinge, dParamLoStop, joint.lower - kStopMargin);

  // The motor is a row of its own: ODE would replace a hinge's motor by its stop, and push without
  // limit.
  out.motor = dJointCreateAMotor(ode_.get(), nullptr);
  dJointAttach(out.motor, out.child, parent);
  dJointSetAMotorMode(out.motor, dAMotorUser);
  dJointSetAMotorNumAxes(out.motor, 1);
  dJointSetAMotorAxis(out.motor, 0, 1, axis.x(), axis.y(), axis.z());
  dJointSetFeedback(out.motor, &out.feedback);
}

void OdeWorld::build_object(const WorldBody& object) {
  if (object.fixed) {
    contacts_.add_object(object.rigid, nullptr, object.pose);
    add_visuals(object.rigid, 0, object.pose);
    fixed_objects_.emplace(object.model, object.pose);
    return;
  }
  const Body body = make_body(object.rigid, object.pose);
  sleep_.add(body.id);
  contacts_.add_object(object.rigid, body.id, object.pose);
  add_visuals(object.rigid, add_frame(object.rigid.name, body), Eigen::Isometry3d::Identity());
  objects_.emplace(object.model, body);
  for (const Kick& kick : object.kicks) {
    kicks_.push_back({std::llround(kick.time_s / step_s_), body.id, kick.velocity});
  }
}

void OdeWorld::kick_due() {
  while (!kicks_.empty() && kicks_.back().step <= steps_) {
    const PendingKick& kick = kicks_.back();
    const Eigen::Vector3d v = to_eigen(dBodyGetLinearVel(kick.body)) + kick.velocity;
    sleep_.wake(kick.body);
    dBodySetLinearVel(kick.body, v.x(), v.y(), v.z());
    kicks_.pop_back();
  }
}

void OdeWorld::drive_motors(std::span<const MotorDrive> drives, double supply_volts) {
  for (std::size_t i = 0; i < ode_joints_.size(); ++i) {
    const MotorDrive drive = i < drives.size() ? drives[i] : MotorDrive{};
    const JointMotor::Row row =
        motors_[i].prepare(drive, supply_volts, joint_states_[i].angle, joint_states_[i].velocity);
    set_row(ode_joints_[i].motor, row);
  }
}

// ODE's motors push and pull alike; what only pushes is a stop. A stop's goal is ERP * way / step, and
// its ERP may be negative.
void OdeWorld::set_row(dJointID motor, const JointMotor::Row& row) const {
  const bool low = row.least == 0, high = row.most == 0;
  dJointSetAMotorParam(motor, dParamLoStop, low ? 0 : -dInfinity);
  dJointSetAMotorParam(motor, dParamHiStop, high ? 0 : dInfinity);
  if (!low && !high) {
    dJointSetAMotorParam(motor, dParamVel, row.velocity);
    dJointSetAMotorParam(motor, dParamCFM, row.softness);
    dJointSetAMotorParam(motor, dParamFMax, row.most);
    return;
  }
  dJointSetAMotorParam(motor, dParamFMax, 0);
  const double side = low ? 1.0 : -1.0;
  dJointSetAMotorAngle(motor, 0, -side * step_s_ * std::abs(row.velocity));
  dJointSetAMotorParam(motor, dParamStopERP, std::copysign(1.0, side * row.velocity));
  dJointSetAMotorParam(motor, dParamStopCFM, row.softness);
}

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

void OdeWorld::step(std::span<const MotorDrive> drives, double supply_volts) {
  enter_ode();
  kick_due();
  contacts_.update();
  drive_motors(drives, supply_volts);
  sleep_.update(step_s_);
  const Eigen::Vector3d velocity_before = imu_velocity();
  solve();
  ++steps_;
  read_joints();
  read_imu(velocity_before);
  for (std::size_t i = 0; i < ode_joints_.size(); ++i) {
    motors_[i].finish(joint_states_[i].velocity, joint_states_[i].torque);
  }
  read_motors();
}

void OdeWorld::read_motors() {
  current_ = 0;
  for (std::size_t i = 0; i < ode_joints_.size(); ++i) {
    joint_states_[i].winding_celsius = motors_[i].winding_celsius();
    joint_states_[i].current = motors_[i].motor_current();
    current_ += motors_[i].supply_current();
  }
}

int OdeWorld::find_contacts() {
  enter_ode();
  contacts_.update();
  return contacts_.count();
}

void OdeWorld::read_joints() {
  for (std::size_t i = 0; i < ode_joints_.size(); ++i) {
    Joint& joint = ode_joints_[i];
    JointState& state = joint_states_[i];
    state.angle = dJointGetHingeAngle(joint.hinge);
    state.velocity = dJointGetHingeAngleRate(joint.hinge);
    const Eigen::Vector3d axis = rotation_to_eigen(dBodyGetRotation(joint.child)) * joint.axis;
    state.torque = axis.dot(to_eigen(joint.feedback.t1));
    dVector3 a, b;
    dJointGetHingeAnchor(joint.hinge, a);
    dJointGetHingeAnchor2(joint.hinge, b);
    largest_gap_ = std::max(largest_gap_, (to_eigen(a) - to_eigen(b)).norm());
  }
}

// Of the sensor's place, world axes.
Eigen::Vector3d OdeWorld::imu_velocity() const {
  const Body& body = robot_bodies_[static_cast<std::size_t>(imu_frame_.link)];
  if (body.id == nullptr) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d arm =
      pose_of(body).linear() * (imu_frame_.in_link.translation() - body.com);
  return to_eigen(dBodyGetLinearVel(body.id)) + to_eigen(dBodyGetAngularVel(body.id)).cross(arm);
}

void OdeWorld::read_imu(const Eigen::Vector3d& velocity_before) {
  const Body& body = robot_bodies_[static_cast<std::size_t>(imu_frame_.link)];
  dVector3 gravity;
  dWorldGetGravity(ode_.get(), gravity);
  const Eigen::Matrix3d to_sensor =
      (pose_of(body).linear() * imu_frame_.in_link.linear()).transpose();
  if (body.id != nullptr) imu_.angular_velocity = to_sensor * to_eigen(dBodyGetAngularVel(body.id));
  imu_.specific_force =
      to_sensor * ((imu_velocity() - velocity_before) / step_s_ - to_eigen(gravity));
}

Eigen::Isometry3d OdeWorld::pose_of(const Body& body) {
  if (body.id == nullptr) return body.fixed;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_to_eigen(dBodyGetRotation(body.id));
  pose.translation() = to_eigen(dBodyGetPosition(body.id)) - pose.linear() * body.com;
  return pose;
}

ScenePose OdeWorld::pose() const {
  ScenePose pose;
  pose.frames.reserve(frames_.size() + 1);
  pose.frames.push_back(Eigen::Isometry3d::Identity());
  for (const Body& body : frames_) pose.frames.push_back(pose_of(body));
  return pose;
}

Eigen::Isometry3d OdeWorld::link_pose(const std::string& link) const {
  const auto frame = link_frames_.find(link);
  if (frame == link_frames_.end()) return Eigen::Isometry3d::Identity();
  return pose_of(robot_bodies_[static_cast<std::size_t>(frame->second.link)]) *
         frame->second.in_link;
}

Result<Eigen::Vector3d> OdeWorld::object_position(const std::string& model) const {
  if (const auto object = objects_.find(model); object != objects_.end()) {
    return pose_of(object->second).translation();
  }
  if (const auto object = fixed_objects_.find(model); object != fixed_objects_.end()) {
    return Eigen::Vector3d(object->second.translation());
  }
  std::string known;
  for (const auto& [name, body] : objects_) {
    if (!known.empty()) known += ", ";
    known += name;
  }
  return fail(Fault::usage, "the world has no object `" + model +
                                "`; those that can move: " + (known.empty() ? "none" : known));
}

std::string OdeWorld::stepper() const {
  return iterations_ == 0 ? "exact" : "quick" + std::to_string(iterations_);
}

}  // namespace kaz::sim
