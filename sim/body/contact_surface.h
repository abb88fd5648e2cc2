// What two surfaces do to each other where they touch.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/body/ode_handles.h"
#include "sim/body/rigid_link.h"

namespace kaz::sim {

// `motion`: velocity of the one body's centre against the other's, m/s. `normal`: of the contact.
dContact contact_of(const Surface& a, const Surface& b, const Eigen::Vector3d& motion,
                    const Eigen::Vector3d& normal, double least_softness);

}  // namespace kaz::sim
