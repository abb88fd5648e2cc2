// Puts bodies to sleep that have lain still for a while, until something touches them.
// SPDX-License-Identifier: Apache-2.0
//
// The rule is ODE's "auto disable" with one sample: a body that something holds, slower than both
// thresholds for as long as said, stops. ODE's own counters can neither be read nor set, so that a
// saved world would not go on as the one that it was saved from; these can.
#pragma once

#include <vector>

#include "sim/body/contact/ode_handles.h"

namespace kaz::sim {

// Objects lie still below these for a moment, and are then left out until something touches them.
struct SleepRule {
  double linear = 0.003, angular = 0.15;  // m/s, rad/s; above either a body is awake
  double after_s = 0.25;
};

class BodySleep {
 public:
  void add(dBodyID body) { bodies_.push_back({body, SleepRule{}.after_s}); }
  void wake(dBodyID body);
  // To be called before each step of the solver, with its contacts made.
  void update(double step_s);

  // How long each has still to lie, in the order of add().
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
