// Puts a resting ODE body to sleep until a moving body touches the resting body.
// SPDX-License-Identifier: Apache-2.0
//
// The rule is ODE's "auto disable", applied to the speeds of the last step only (one sample). A body in
// contact is put to sleep after the body's speeds have been below both thresholds for SleepRule::after_s.
// The time at rest is counted in this class, because the counters inside ODE cannot be saved and restored.
// The counters of this class are part of the saved state.
#pragma once

#include <cstddef>
#include <vector>

#include "sim/body/contact/ode_handles.h"

namespace kaz::sim {

struct SleepRule {
  // Thresholds in m/s and rad/s. A body with a speed above either threshold stays awake.
  double linear = 0.003, angular = 0.15;
  double after_s = 0.25;
};

class BodySleep {
 public:
  void add(dBodyID body) { bodies_.push_back({body, SleepRule{}.after_s}); }
  // Enables the body and restarts the body's time at rest.
  void wake(dBodyID body);
  // Call before each solver step, after the contacts of this step have been created.
  void update(double step_s);

  // Copies the remaining times until sleep from `other`, which must have the same number of bodies.
  void continue_from(const BodySleep& other) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) bodies_[i].left_s = other.bodies_[i].left_s;
  }

  // Archives, for each body in the order of add(), the time until the body sleeps.
  template <class A>
  void transfer(A& a) {
    for (Sleeper& sleeper : bodies_) a(sleeper.left_s);
  }

 private:
  struct Sleeper {
    dBodyID body;
    double left_s;
  };
  std::vector<Sleeper> bodies_;
};

}  // namespace kaz::sim
