// A joint row in Bullet's solver: a motor with the law of joint_motor.h, or a stop.
// SPDX-License-Identifier: Apache-2.0
//
// Bullet's btMultiBodyJointMotor drives to a velocity with a bounded torque and has no softness, so it cannot
// model the motor line, whose softness is back-EMF and rotor inertia (joint_motor.h). Bullet's contact rows
// can be soft; this is a joint row of the same kind:
//     w_new + softness T = velocity,  min <= T <= max
#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>

namespace kaz::sim::bench {

class BulletJointRow final : public btMultiBodyConstraint {
 public:
  // `sign`: of the joint's velocity in the row.
  BulletJointRow(btMultiBody* body, int link, double sign);

  // For the coming step: rad/s, rad/s per Nm, Nm.
  void set(double velocity, double softness, double min, double max);
  // No row in the coming step.
  void rest() { active_ = false; }
  double torque(double step_s);  // Nm, in the last step, in the joint's own direction

  void finalizeMultiDof() override;
  int getIslandIdA() const override { return island(m_linkA); }
  int getIslandIdB() const override { return island(m_linkB); }
  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                            const btContactSolverInfo& info) override;
  void debugDraw(btIDebugDraw*) override {}

 private:
  int island(int link) const;
  double sign_;
  bool active_ = false;
  double velocity_ = 0, softness_ = 0, min_ = 0, max_ = 0;
};

}  // namespace kaz::sim::bench
