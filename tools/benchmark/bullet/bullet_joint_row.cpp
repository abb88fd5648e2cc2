// A row of a joint in Bullet's solver.
// SPDX-License-Identifier: Apache-2.0
#include "tools/benchmark/bullet/bullet_joint_row.h"

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

namespace kaz::sim::bench {

BulletJointRow::BulletJointRow(btMultiBody* body, int link, double sign)
    : btMultiBodyConstraint(body, body, link, body->getLink(link).m_parent, 1, true,
                            MULTIBODY_CONSTRAINT_1DOF_JOINT_MOTOR),
      sign_(sign) {
  finalizeMultiDof();
}

void BulletJointRow::finalizeMultiDof() {
  allocateJacobiansMultiDof();
  jacobianA(0)[6 + m_bodyA->getLink(m_linkA).m_dofOffset] = sign_;
  m_numDofsFinalized = m_jacSizeBoth;
}

void BulletJointRow::set(double velocity, double softness, double min, double max) {
  active_ = true;
  velocity_ = velocity;
  softness_ = softness;
  min_ = min;
  max_ = max;
}

double BulletJointRow::torque(double step_s) {
  return active_ ? sign_ * getAppliedImpulse(0) / step_s : 0;
}

// A link without a shape has no collider and is in the island of the base.
int BulletJointRow::island(int link) const {
  const btMultiBodyLinkCollider* collider =
      link < 0 ? m_bodyA->getBaseCollider() : m_bodyA->getLink(link).m_collider;
  if (!collider) collider = m_bodyA->getBaseCollider();
  return collider ? collider->getIslandTag() : -1;
}

void BulletJointRow::createConstraintRows(btMultiBodyConstraintArray& rows,
                                          btMultiBodyJacobianData& data,
                                          const btContactSolverInfo& info) {
  if (!active_) return;
  const double h = info.m_timeStep;
  btMultiBodySolverConstraint& row = rows.expandNonInitializing();
  const btVector3 none(0, 0, 0);
  fillMultiBodyConstraint(row, data, jacobianA(0), jacobianB(0), none, none, none, none, 0, info,
                          min_ * h, max_ * h);
  // As a soft contact's: the row yields by softness / h for each Nms.
  const double give = softness_ / h;
  const double now = sign_ * m_bodyA->getJointVel(m_linkA);
  const double inverse = 1 / (1 / row.m_jacDiagABInv + give);
  row.m_jacDiagABInv = inverse;
  row.m_cfm = give * inverse;
  row.m_rhs = (velocity_ - now) * inverse;
  row.m_rhsPenetration = 0;
  row.m_orgConstraint = this;
  row.m_orgDofIndex = 0;
}

}  // namespace kaz::sim::bench
