// Parts of a netlist. Programs can derive other parts from the class Part.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "sim/h8s/netlist/netlist.h"

namespace kaz::h8s {

// Switch or push button from a net to the supply or to ground.
class Switch : public Part {
 public:
  Switch(Net net, bool to_supply) : net_(net), to_supply_(to_supply) {}
  // Opens or closes the switch at the netlist's current time.
  void set(Netlist& n, bool closed);
  // Opens or closes the switch at the time `at`. Calls must be in ascending order of time.
  void set_at(Netlist& n, States at, bool closed);
  bool closed() const { return closed_; }

  void start(Netlist& n, States at) override;
  void woken(Netlist& n, States at) override;
  std::vector<double> save() const override { return {closed_ ? 1.0 : 0.0}; }
  void restore(std::span<const double> values) override { closed_ = values[0] != 0; }

 private:
  void plan(Netlist& n, States at);
  Net net_;
  bool to_supply_, closed_ = false;
  int output_ = -1;
  std::vector<std::pair<States, bool>> schedule_;
};

// Inverter with a delay in states.
class Inverter : public Part {
 public:
  Inverter(Net in, Net out, States delay = 0) : in_(in), out_(out), delay_(delay) {}
  void start(Netlist& n, States at) override;
  void changed(Netlist& n, Net net, States at) override;
  void woken(Netlist& n, States at) override;
  std::vector<double> save() const override;
  void restore(std::span<const double> values) override;

 private:
  Net in_, out_;
  States delay_;
  int output_ = -1;
  bool wanted_ = false, shown_ = false;
  std::deque<std::pair<States, bool>> under_way_;  // delayed changes of the output
};

// Open-drain stage: pulls the output to ground while the input is high; otherwise does not drive the output.
class OpenDrain : public Part {
 public:
  OpenDrain(Net in, Net out) : in_(in), out_(out) {}
  void start(Netlist& n, States at) override;
  void changed(Netlist& n, Net net, States at) override;

 private:
  Net in_, out_;
  int output_ = -1;
};

// Low-pass: a resistor, and a capacitor to ground. Between two edges of the input, the output voltage is
// `v = vin + (v0 - vin) exp(-t / RC)`. The time t begins at the first of these two edges. v0 is the output
// voltage at t = 0, and vin is the input voltage. The output voltage stays constant while the input is not
// driven. The output must not be loaded. The input must not be driven by a moving voltage (Netlist::drive).
class Rc : public Part {
 public:
  Rc(Net in, Net out, double ohms, double farads)
      : in_(in), out_(out), ohms_(ohms), farads_(farads) {}
  void start(Netlist& n, States at) override;
  void changed(Netlist& n, Net net, States at) override;
  void woken(Netlist& n, States at) override;
  double voltage(States at) const override;
  std::vector<double> save() const override;
  void restore(std::span<const double> values) override;

 private:
  void plan(Netlist& n, States at);
  Net in_, out_;
  double ohms_, farads_, tau_ = 1;  // tau_: time constant, states
  double from_ = 0, to_ = 0;        // from_: voltage at the time since_; to_: final voltage
  bool driven_ = false;
  States since_ = 0;
  int output_ = -1;
};

// Voltage divider: a resistor from the input to the output, and a resistor from the output to ground.
class Divider : public Part {
 public:
  Divider(Net in, Net out, double upper_ohms, double lower_ohms)
      : in_(in), out_(out), upper_(upper_ohms), lower_(lower_ohms) {}
  void start(Netlist& n, States at) override;
  void changed(Netlist& n, Net net, States at) override;

 private:
  Net in_, out_;
  double upper_, lower_;
  int output_ = -1;
};

// LED or logic probe: records the levels of a net and the times of the changes.
class Probe : public Part {
 public:
  Probe(Net net, std::string name) : net_(net), name_(std::move(name)) {}
  const std::string& name() const { return name_; }
  // Returns pairs of a time and a level. The first pair contains the level at the start. Each further
  // pair contains the time of a change and the new level.
  const std::vector<std::pair<States, bool>>& levels() const { return levels_; }
  // Returns the fraction of the time from `from` to `to` during which the net was high.
  double high_share(States from, States to) const;
  void start(Netlist& n, States at) override;
  void changed(Netlist& n, Net net, States at) override;

 private:
  Net net_;
  std::string name_;
  bool placed_ = false;
  std::vector<std::pair<States, bool>> levels_;
};

}  // namespace kaz::h8s
