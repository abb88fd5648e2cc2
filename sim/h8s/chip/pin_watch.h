// Listeners of pins, and function calls that are scheduled for a given time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "sim/h8s/chip/pins.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

// Returns level, driver and pull-up of a pin at the time `at`. The modules must have been advanced to `at`.
PinState pin_state(const Machine& m, Pin pin, States at);
// Returns the earliest time after `at` at which the module that drives the pin can change the pin's level.
States next_pin_change(const Machine& m, Pin pin, States at);

// A PinWatch belongs to a machine, but is not part of the machine's state: the PinWatch is neither copied nor
// restored.
class PinWatch {
 public:
  bool active() const { return !watched_.empty() || !calls_.empty(); }
  // Returns whether a pin of these ports is watched. Bit n is port n.
  bool watches(unsigned ports) const { return (ports_ & ports) != 0; }
  int watch(const Machine& m, Pin pin, PinListener listener, bool drivers, States at);
  void unwatch(int id);
  int call_at(States at, std::function<void(States)> call);
  void cancel(int id);

  States next_event(const Machine& m) const;
  // Reports the edges at the time `to` and makes the calls that are due.
  void advance(Machine& m, States to);
  // Reports the edges at the time `at`. Must be called after a change from outside.
  void sample(Machine& m, States at);
  // Stores the current levels without reporting edges. Must be called after the chip's state was replaced.
  void forget(const Machine& m, States at);

 private:
  void find_ports();
  struct Watched {
    int id;
    Pin pin;
    PinState last;
    bool drivers;  // true: changes of driver and pull-up are also reported
    PinListener listener;
  };
  struct Call {
    int id;
    std::function<void(States)> call;
  };
  bool report_once(Machine& m, States at);

  std::vector<Watched> watched_;
  std::multimap<States, Call> calls_;
  int next_id_ = 1;
  States sampled_ = 0;  // edges up to this time have been reported
  bool reporting_ = false;
  unsigned ports_ = 0;  // ports with watched pins; bit n is port n
};

}  // namespace kaz::h8s
