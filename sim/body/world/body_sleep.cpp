// Puts resting bodies to sleep.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/world/body_sleep.h"

namespace kaz::sim {

void BodySleep::wake(dBodyID body) {
  dBodyEnable(body);
  for (Sleeper& sleeper : bodies_) {
    if (sleeper.body == body) sleeper.left_s = SleepRule{}.after_s;
  }
}

void BodySleep::update(double step_s) {
  constexpr SleepRule rule;
  for (Sleeper& sleeper : bodies_) {
    // Bodies without contacts do not sleep.
    if (dBodyIsEnabled(sleeper.body) == 0 || dBodyGetNumJoints(sleeper.body) == 0) continue;
    const double linear = to_eigen(dBodyGetLinearVel(sleeper.body)).squaredNorm();
    const double angular = to_eigen(dBodyGetAngularVel(sleeper.body)).squaredNorm();
    if (linear > rule.linear * rule.linear || angular > rule.angular * rule.angular) {
      sleeper.left_s = SleepRule{}.after_s;
      continue;
    }
    sleeper.left_s -= step_s;
    if (sleeper.left_s > 0) continue;
    dBodyDisable(sleeper.body);
    dBodySetLinearVel(sleeper.body, 0, 0, 0);
    dBodySetAngularVel(sleeper.body, 0, 0, 0);
  }
}

}  // namespace kaz::sim
