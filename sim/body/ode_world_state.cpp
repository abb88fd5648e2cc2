// The world's state to bytes and back.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/body/ode_world.h"

namespace kaz::sim {
namespace {

// dBodySetQuaternion() normalizes once more, which may change the last bit, and so might the
// rotation that follows from it: both are put where ODE keeps them, after it has been told that the
// body moved.
void place(dBodyID body, const std::array<double, 4>& q, const std::array<double, 12>& r) {
  dBodySetQuaternion(body, q.data());
  std::ranges::copy(q, const_cast<dReal*>(dBodyGetQuaternion(body)));
  std::ranges::copy(r, const_cast<dReal*>(dBodyGetRotation(body)));
}

template <class A>
void transfer_body(A& a, dBodyID body) {
  std::array<double, 3> at{}, linear{}, angular{};
  std::array<double, 4> q{};
  std::array<double, 12> r{};
  bool awake = dBodyIsEnabled(body) != 0;
  std::copy_n(dBodyGetPosition(body), 3, at.begin());
  std::copy_n(dBodyGetQuaternion(body), 4, q.begin());
  std::copy_n(dBodyGetRotation(body), 12, r.begin());
  std::copy_n(dBodyGetLinearVel(body), 3, linear.begin());
  std::copy_n(dBodyGetAngularVel(body), 3, angular.begin());
  a(at, q, r, linear, angular, awake);
  if constexpr (A::reading) {
    if (!a.good()) return;
    dBodySetPosition(body, at[0], at[1], at[2]);
    place(body, q, r);
    dBodySetLinearVel(body, linear[0], linear[1], linear[2]);
    dBodySetAngularVel(body, angular[0], angular[1], angular[2]);
    awake ? dBodyEnable(body) : dBodyDisable(body);
  }
}

}  // namespace

template <class A>
void OdeWorld::transfer(A& a) {
  auto bodies = static_cast<std::uint32_t>(frames_.size());
  auto kicks = static_cast<std::uint32_t>(kicks_.size());
  a(bodies, kicks);
  if (bodies != frames_.size() || kicks > kicks_.size()) return a.refuse("it is of another world");
  if (!a.good()) return;
  kicks_.resize(kicks);
  std::uint64_t random = random_state_;
  a(steps_, random, current_, largest_gap_, sleep_);
  random_state_ = static_cast<unsigned long>(random);
  for (JointMotor& motor : motors_) a(motor);
  for (JointState& joint : joint_states_) {
    a(joint.angle, joint.velocity, joint.torque, joint.current, joint.winding_celsius);
  }
  for (const Body& body : frames_) {
    if (body.id != nullptr) transfer_body(a, body.id);
  }
  for (Eigen::Vector3d* v : {&imu_.angular_velocity, &imu_.specific_force})
    for (int k = 0; k < 3; ++k) a((*v)[k]);
}

void OdeWorld::save(h8s::StateWriter& to) {
  transfer(to);
}

void OdeWorld::restore(h8s::StateReader& from) {
  // Kicks that are over here may still be to come there.
  kicks_ = all_kicks_;
  transfer(from);
}

}  // namespace kaz::sim
