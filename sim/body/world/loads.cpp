// SPDX-License-Identifier: Apache-2.0
#include "sim/body/world/loads.h"

namespace kaz::sim {

void LinkForce::add(const Eigen::Isometry3d& link, const Eigen::Vector3d& at,
                    const Eigen::Vector3d& push, const Eigen::Vector3d& turn, double normal) {
  const Eigen::Matrix3d to_link = link.linear().transpose();
  const Eigen::Vector3d arm = to_link * (at - link.translation());
  const Eigen::Vector3d f = to_link * push;
  force += f;
  moment += arm.cross(f) + to_link * turn;
  pressure += normal;
  centre += normal * arm;
}

}  // namespace kaz::sim
