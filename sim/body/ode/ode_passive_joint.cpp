// World on the Open Dynamics Engine: passive joints between objects.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact/contact_surface.h"
#include "sim/body/ode/ode_world.h"

namespace kaz::sim {

// The world is in its start pose, to which the stops refer. ODE keeps the joint until the world's end.
// Damping is a motor with the target speed 0 and the compliance 1 / damping. Friction is a motor with the
// target speed 0 and a largest force.
void OdeWorld::build_passive_joint(const WorldJoint& from) {
  const dBodyID child = body(from.child), parent = body(from.parent);
  const Eigen::Vector3d &at = from.anchor, &axis = from.axis;
  if (from.kind == WorldJoint::Kind::ball) {
    const dJointID ball = dJointCreateBall(ode_.get(), nullptr);
    dJointAttach(ball, child, parent);
    dJointSetBallAnchor(ball, at.x(), at.y(), at.z());
    return;
  }
  const bool hinge = from.kind == WorldJoint::Kind::revolute;
  const dJointID joint =
      hinge ? dJointCreateHinge(ode_.get(), nullptr) : dJointCreateSlider(ode_.get(), nullptr);
  dJointAttach(joint, child, parent);
  if (hinge) {
    dJointSetHingeAnchor(joint, at.x(), at.y(), at.z());
    dJointSetHingeAxis(joint, axis.x(), axis.y(), axis.z());
  } else {
    dJointSetSliderAxis(joint, axis.x(), axis.y(), axis.z());
  }
  const auto set = [&](int parameter, double value) {
    hinge ? dJointSetHingeParam(joint, parameter, value)
          : dJointSetSliderParam(joint, parameter, value);
  };
  set(dParamLoStop, from.lower);
  set(dParamHiStop, from.upper);
  set(dParamStopERP, erp_for(step_s_, kStopErp));
  if (from.damping > 0) {
    set(dParamFMax, dInfinity);
    set(dParamCFM, 1 / from.damping);
  } else if (from.friction > 0) {
    set(dParamFMax, from.friction);
  }
}

}  // namespace kaz::sim
