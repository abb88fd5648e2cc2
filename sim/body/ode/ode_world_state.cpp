// Saving and restoring the world's state.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/body/ode/ode_world.h"
#include "sim/body/world/saved_pose.h"

namespace kaz::sim {
namespace {

// dBodySetQuaternion() normalises again, which may change the last bit of the quaternion and of the
// rotation matrix computed from it. It is called so that ODE notes that the body moved; then both are
// overwritten with the saved bits.
void place(dBodyID body, const std::array<double, 4>& q, const std::array<double, 12>& r) {
  dBodySetQuaternion(body, q.data());
  std::ranges::copy(q, const_cast<dReal*>(dBodyGetQuaternion(body)));
  std::ranges::copy(r, const_cast<dReal*>(dBodyGetRotation(body)));
}

// All that a body carries from step to step.
struct BodyState {
  std::array<double, 3> at{}, linear{}, angular{};
  std::array<double, 4> q{};
  std::array<double, 12> r{};
  bool awake = true;

  template <class A>
  void transfer(A& a) {
    a(at, q, r, linear, angular, awake);
    const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
    // Rows of four; the matrix follows from the quaternion.
    using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
    const Eigen::Matrix3d matrix = Eigen::Map<const Rows>(r.data()).leftCols<3>();
    a.require(is_saved_place(Eigen::Map<const Eigen::Vector3d>(at.data())) &&
                  is_saved_motion(Eigen::Map<const Eigen::Vector3d>(linear.data())) &&
                  is_saved_motion(Eigen::Map<const Eigen::Vector3d>(angular.data())) &&
                  is_saved_turn(turn) &&
                  (matrix - turn.toRotationMatrix()).cwiseAbs().maxCoeff() < 1e-6,
              "body pose");
  }
};

BodyState state_of(dBodyID body) {
  BodyState state;
  state.awake = dBodyIsEnabled(body) != 0;
  std::copy_n(dBodyGetPosition(body), 3, state.at.begin());
  std::copy_n(dBodyGetQuaternion(body), 4, state.q.begin());
  std::copy_n(dBodyGetRotation(body), 12, state.r.begin());
  std::copy_n(dBodyGetLinearVel(body), 3, state.linear.begin());
  std::copy_n(dBodyGetAngularVel(body), 3, state.angular.begin());
  return state;
}

void set_state(dBodyID body, const BodyState& state) {
  const auto& [at, linear, angular, q, r, awake] = state;
  dBodySetPosition(body, at[0], at[1], at[2]);
  place(body, q, r);
  dBodySetLinearVel(body, linear[0], linear[1], linear[2]);
  dBodySetAngularVel(body, angular[0], angular[1], angular[2]);
  awake ? dBodyEnable(body) : dBodyDisable(body);
}

}  // namespace

void OdeWorld::copy_bodies(const OdeWorld& from) {
  for (std::size_t i = 0; i < ode_bodies_.size(); ++i) {
    if (ode_bodies_[i] != nullptr) set_state(ode_bodies_[i], state_of(from.ode_bodies_[i]));
  }
}

template <class A>
void OdeWorld::transfer(A& a) {
  transfer_stage(a);
  if (!a.good()) return;
  std::uint64_t random = random_state_;
  a(random, largest_gap_, sleep_, memory_);
  random_state_ = static_cast<unsigned long>(random);
  for (const dBodyID body : ode_bodies_) {
    if (body == nullptr) continue;
    BodyState state = state_of(body);
    a(state);
    if constexpr (A::reading) {
      if (a.good()) set_state(body, state);
    }
  }
}

void OdeWorld::save(StateWriter& to) {
  transfer(to);
}

void OdeWorld::restore(StateReader& from) {
  transfer(from);
}

}  // namespace kaz::sim
