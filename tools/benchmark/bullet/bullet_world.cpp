// The robot and the other bodies in Bullet's multibody dynamics.
// SPDX-License-Identifier: Apache-2.0
#include "tools/benchmark/bullet/bullet_world.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include "sim/body/world/body_sleep.h"

namespace kaz::sim::bench {
namespace {

constexpr int kExemptGenerations = 3;  // as contacts.cpp
constexpr double kStopWatch = 0.02;    // rad before a stop, as reduced

Eigen::Isometry3d pose_of(const btTransform& at) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = from_bullet(at.getBasis());
  pose.translation() = from_bullet(at.getOrigin());
  return pose;
}

btQuaternion quaternion(const Eigen::Matrix3d& turn) {
  const Eigen::Quaterniond q(turn);
  return {q.x(), q.y(), q.z(), q.w()};
}

}  // namespace

Result<std::unique_ptr<World>> BulletWorld::load(const std::string& world_path,
                                                 const std::string& robot_path,
                                                 const WorldOptions& options) {
  const std::string name = "bullet";
  const int iterations = options.dynamics.compare(0, name.size(), name) == 0
                             ? std::atoi(options.dynamics.c_str() + name.size())
                             : 0;
  if (iterations < 1)
    return fail(Fault::usage, "dynamics \"" + options.dynamics + "\" is not \"bulletN\", N from 1");
  const auto files = KAZ_TRY(read_world_files(world_path, robot_path, options));
  return std::make_unique<BulletWorld>(files.world, files.robot, files.motor, options, iterations);
}

bool BulletWorld::Filter::needBroadphaseCollision(btBroadphaseProxy* a,
                                                  btBroadphaseProxy* b) const {
  if ((a->m_collisionFilterGroup & b->m_collisionFilterMask) == 0 ||
      (b->m_collisionFilterGroup & a->m_collisionFilterMask) == 0)
    return false;
  const auto link = [](const btBroadphaseProxy* proxy) {
    const auto* object = static_cast<const btCollisionObject*>(proxy->m_clientObject);
    const auto* part = btMultiBodyLinkCollider::upcast(object);
    return part ? part->m_link + 1 : -1;
  };
  const int one = link(a), other = link(b);
  if (one < 0 || other < 0) return true;
  return !exempt[static_cast<std::size_t>(one) * links + static_cast<std::size_t>(other)];
}

BulletWorld::BulletWorld(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
                         const WorldOptions& options, int iterations)
    : StagedWorld(world, robot, motor, options), iterations_(iterations) {
  gContactAddedCallback = join_surfaces;
  gDeactivationTime = SleepRule{}.after_s;
  world_.setGravity(to_bullet(world.gravity));
  btContactSolverInfo& solver = world_.getSolverInfo();
  solver.m_numIterations = iterations;
  solver.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;  // or friction acts along one line alone
  world_.getPairCache()->setOverlapFilterCallback(&filter_);
  for (const Body& body : bodies()) frames_.push_back(principal_frame(body.rigid));
  add_robot(robot);
  add_joints(robot);
  add_bodies(world);
  imu_by_differences_.start(body_pose(imu_frame_.link) * imu_frame_.in_link);
}

BulletWorld::~BulletWorld() {
  for (const Joint& joint : joints_) {
    for (const auto* row : {&joint.motor, &joint.lower_stop, &joint.upper_stop})
      world_.removeMultiBodyConstraint(row->get());
  }
  for (const auto& moving : moving_bodies_) world_.removeRigidBody(moving.get());
  for (const auto& object : fixed_) world_.removeCollisionObject(object.get());
  for (const auto& collider : colliders_) world_.removeCollisionObject(collider.get());
  world_.removeMultiBody(robot_.get());
}

void BulletWorld::add_robot(const RobotModel& robot) {
  filter_.links = robot_links_;
  filter_.exempt.assign(robot_links_ * robot_links_, 0);
  for (std::size_t link = 0; link < robot_links_; ++link) {
    int up = static_cast<int>(link);
    for (int i = 0; i <= kExemptGenerations && up >= 0; ++i) {
      const auto other = static_cast<std::size_t>(up);
      filter_.exempt[link * robot_links_ + other] = filter_.exempt[other * robot_links_ + link] = 1;
      up = robot.links[other].parent;
    }
  }
  const RigidLink& root = robot.links[0].rigid;
  robot_ = std::make_unique<btMultiBody>(static_cast<int>(robot_links_) - 1, root.mass,
                                         to_bullet(frames_[0].moments), hung_ || robot.fixed_base,
                                         false);
  robot_->setBaseWorldTransform(
      to_bullet(Eigen::Isometry3d(bodies()[0].start * frames_[0].in_link)));
  robot_->setLinearDamping(0);
  robot_->setAngularDamping(0);
  robot_->setHasSelfCollision(true);
  for (int link = 1; link < static_cast<int>(robot_links_); ++link) set_up_link(robot, link);
  robot_->finalizeMultiDof();
  world_.addMultiBody(robot_.get());
  for (int link = 0; link < static_cast<int>(robot_links_); ++link) add_collider(robot, link);
  btAlignedObjectArray<btQuaternion> turns;
  btAlignedObjectArray<btVector3> origins;
  robot_->forwardKinematics(turns, origins);
  robot_->updateCollisionObjectWorldTransforms(turns, origins);
}

void BulletWorld::set_up_link(const RobotModel& robot, int number) {
  const RobotLink& link = robot.links[static_cast<std::size_t>(number)];
  const auto parent = static_cast<std::size_t>(link.parent);
  const RobotJoint& joint = robot.joints[static_cast<std::size_t>(link.joint)];
  const PrincipalFrame& frame = frames_[static_cast<std::size_t>(number)];
  const Eigen::Isometry3d mine = link.at_zero * frame.in_link;
  const Eigen::Isometry3d its = robot.links[parent].at_zero * frames_[parent].in_link;
  const Eigen::Vector3d pivot = link.at_zero.translation();
  robot_->setupRevolute(number - 1, link.rigid.mass, to_bullet(frame.moments), link.parent - 1,
                        quaternion(mine.linear().transpose() * its.linear()),
                        to_bullet(Eigen::Vector3d(mine.linear().transpose() * joint.axis)),
                        to_bullet(Eigen::Vector3d(its.inverse() * pivot)),
                        to_bullet(Eigen::Vector3d(-(mine.inverse() * pivot))));
}

void BulletWorld::add_collider(const RobotModel& robot, int number) {
  const auto index = static_cast<std::size_t>(number);
  btCollisionShape* shape = shapes_.of_link(robot.links[index].rigid, frames_[index]);
  if (!shape) return;
  auto collider = std::make_unique<btMultiBodyLinkCollider>(robot_.get(), number - 1);
  collider->setCollisionShape(shape);
  collider->setCollisionFlags(collider->getCollisionFlags() |
                              btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
  collider->setWorldTransform(
      to_bullet(Eigen::Isometry3d(bodies()[index].start * frames_[index].in_link)));
  if (number == 0)
    robot_->setBaseCollider(collider.get());
  else
    robot_->getLink(number - 1).m_collider = collider.get();
  world_.addCollisionObject(collider.get(), btBroadphaseProxy::DefaultFilter,
                            btBroadphaseProxy::AllFilter);
  colliders_.push_back(std::move(collider));
}

void BulletWorld::add_joints(const RobotModel& robot) {
  for (const RobotJoint& from : robot.joints) {
    Joint joint;
    joint.link = from.child - 1;
    joint.lower = from.lower - kStopMargin;
    joint.upper = from.upper + kStopMargin;
    const auto row = [&](double sign) {
      auto made = std::make_unique<BulletJointRow>(robot_.get(), joint.link, sign);
      world_.addMultiBodyConstraint(made.get());
      return made;
    };
    joint.motor = row(1);
    joint.lower_stop = row(1);
    joint.upper_stop = row(-1);
    joints_.push_back(std::move(joint));
  }
}

void BulletWorld::add_bodies(const WorldModel& world) {
  auto body = static_cast<int>(robot_links_);
  for (const WorldBody& world_body : world.bodies) {
    if (!world_body.fixed) {
      add_moving_body(world_body, body++);
      continue;
    }
    for (const CollisionShape& part : world_body.rigid.collisions) {
      btTransform at;
      btCollisionShape* shape = shapes_.of_fixed(part, world_body.pose, at);
      if (!shape) continue;
      auto object = std::make_unique<btCollisionObject>();
      object->setCollisionShape(shape);
      object->setWorldTransform(at);
      object->setCollisionFlags(btCollisionObject::CF_STATIC_OBJECT |
                                btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
      world_.addCollisionObject(object.get());
      fixed_.push_back(std::move(object));
    }
  }
}

void BulletWorld::add_moving_body(const WorldBody& world_body, int number) {
  const PrincipalFrame& frame = frames_[static_cast<std::size_t>(number)];
  btRigidBody::btRigidBodyConstructionInfo info(world_body.rigid.mass, nullptr,
                                                shapes_.of_link(world_body.rigid, frame),
                                                to_bullet(frame.moments));
  info.m_startWorldTransform = to_bullet(Eigen::Isometry3d(world_body.pose * frame.in_link));
  info.m_linearSleepingThreshold = SleepRule{}.linear;
  info.m_angularSleepingThreshold = SleepRule{}.angular;
  auto body = std::make_unique<btRigidBody>(info);
  body->setCollisionFlags(body->getCollisionFlags() |
                          btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
  world_.addRigidBody(body.get());
  moving_bodies_.push_back(std::move(body));
}

Eigen::Isometry3d BulletWorld::moving_pose(int body) const {
  const auto index = static_cast<std::size_t>(body);
  const Eigen::Isometry3d back = frames_[index].in_link.inverse();
  if (index >= robot_links_)
    return pose_of(moving_bodies_[index - robot_links_]->getWorldTransform()) * back;
  if (body == 0) return pose_of(robot_->getBaseWorldTransform()) * back;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = from_bullet(robot_->localPosToWorld(body - 1, btVector3(0, 0, 0)));
  pose.linear() = from_bullet(robot_->localFrameToWorld(body - 1, btMatrix3x3::getIdentity()));
  return pose * back;
}

void BulletWorld::kick(int body, const Eigen::Vector3d& velocity) {
  btRigidBody& moving = *moving_bodies_[static_cast<std::size_t>(body) - robot_links_];
  moving.setLinearVelocity(moving.getLinearVelocity() + to_bullet(velocity));
  moving.activate(true);
}

void BulletWorld::set_joint_rows() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    const JointMotor::Row& row = rows_[i];
    joint.motor->set(row.velocity, row.softness, row.min, row.max);
    const double watch = kStopWatch + step_s_ * std::abs(joint_states_[i].velocity);
    const auto stop = [&](BulletJointRow& out, double gap) {  // rad, to the stop
      if (gap > watch) return out.rest();
      out.set(gap > 0 ? -gap / step_s_ : -kStopErp * gap / step_s_, kStopSoftness, 0,
              std::numeric_limits<double>::max());
    };
    stop(*joint.lower_stop, joint_states_[i].angle - joint.lower);
    stop(*joint.upper_stop, joint.upper - joint_states_[i].angle);
  }
}

void BulletWorld::read_joints() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    joint_states_[i].angle = robot_->getJointPos(joints_[i].link);
    joint_states_[i].velocity = robot_->getJointVel(joints_[i].link);
    joint_states_[i].torque = joints_[i].motor->torque(step_s_);
  }
}

void BulletWorld::step(std::span<const MotorDrive> drives, double supply_volts) {
  kick_due();
  prepare_motors(drives, supply_volts);
  set_joint_rows();
  for (const HandPush& push : hand_pushes_) {
    const btVector3 force = to_bullet(Eigen::Vector3d(push.impulse / step_s_));
    if (push.link == 0)
      robot_->addBaseForce(force);
    else
      robot_->addLinkForce(static_cast<int>(push.link) - 1, force);
  }
  hand_pushes_.clear();
  world_.stepSimulation(step_s_, 0);  // 0: this one step, whole
  ++steps_;
  read_joints();
  finish_motors();
  imu_ =
      imu_by_differences_.read(body_pose(imu_frame_.link) * imu_frame_.in_link, step_s_, gravity_);
}

int BulletWorld::find_contacts() {
  world_.performDiscreteCollisionDetection();
  int points = 0;
  for (int i = 0; i < dispatcher_.getNumManifolds(); ++i)
    points += dispatcher_.getManifoldByIndexInternal(i)->getNumContacts();
  return points;
}

}  // namespace kaz::sim::bench
