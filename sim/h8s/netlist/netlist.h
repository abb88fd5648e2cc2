// Netlist of the circuit around the chip: nets that connect pins, and parts that are connected to these nets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/h8s/chip/chip.h"

namespace kaz::h8s {

class Netlist;

// Index of a net. After wire() several indices may mean the same net.
using Net = int;

// Base class of parts. A part drives nets through outputs (Netlist::output), is notified of changes on nets
// (Netlist::listen), and can schedule a call (Netlist::wake). If a part changes an output during a
// notification, the change takes effect at the time of the notification.
class Part {
 public:
  virtual ~Part() = default;
  // Called once when the part is added, and after Netlist::restore.
  virtual void start(Netlist&, States) {}
  // If the part listens to a net, the netlist calls this function after the net's voltage has changed, or
  // after the net has become driven or undriven.
  virtual void changed(Netlist&, Net, States /*at*/) {}
  // Called at the time scheduled with Netlist::wake.
  virtual void woken(Netlist&, States /*at*/) {}
  // Returns the voltage of an output as a fraction of AVCC. Called only for outputs that Netlist::drive has
  // set to `moving`: the voltage of these outputs changes continuously.
  virtual double voltage(States /*at*/) const { return 0; }
  // State of the part, for Netlist::save and restore.
  virtual std::vector<double> save() const { return {}; }
  virtual void restore(std::span<const double>) {}
};

// A conflict on a net: two strong drivers with different levels, or a loop that does not settle. For a loop,
// `second` is empty.
struct Conflict {
  std::string net, first, second;
  States at = 0;
  std::string text() const;
};

// Voltages are fractions of AVCC: 0 is ground, 1 is the supply. A net is high at 0.5 and above. A netlist
// must be used in the thread that uses the chip.
class Netlist {
 public:
  struct Settings {
    std::int64_t hertz = 18'432'000;  // states per second
    double pull_up_ohms = 50'000;     // resistance of the chip's internal pull-ups
    double weak_high_ohms = 1'000;    // resistance of P47 and P52 (NMOS push-pull) while high
  };
  // Watches all pins of the chip that are connected to nets. If anything other than the chip drives the net
  // of a pin, the netlist sets the input level of the pin. Becomes the analog source of the chip. `chip` must
  // outlive this object and must not be moved.
  explicit Netlist(Chip& chip);
  Netlist(Chip& chip, const Settings& settings);
  ~Netlist();
  Netlist(const Netlist&) = delete;
  Netlist& operator=(const Netlist&) = delete;

  // Returns the net called `name`: any name of a pin, "vcc", "gnd", or another name. Creates the net if it
  // does not exist.
  Net net(std::string_view name);
  // Joins two nets into one.
  void wire(Net a, Net b);
  // Adds a part, which the netlist then owns.
  template <class P>
  P& add(std::unique_ptr<P> part) {
    P& p = *part;
    parts_.push_back(std::move(part));
    place(p);
    return p;
  }
  // Adds a source of constant voltage with a series resistance. If `ohms` is 0, the source is a strong drive.
  void source(Net net, double voltage, double ohms, const std::string& name);
  void pull_up(Net net, double ohms) { source(net, 1, ohms, "pull-up"); }
  void pull_down(Net net, double ohms) { source(net, 0, ohms, "pull-down"); }

  // Returns the voltage of a net; nullopt if the net is not driven. A strong drive overrides all other
  // drives. If strong drives conflict, the lowest voltage applies. Without a strong drive, the voltage is the
  // mean of the drives, weighted by conductance.
  std::optional<double> voltage(Net net, States at) const;
  // Returns whether a net is high. A net that is not driven counts as low.
  bool level(Net net) const;
  const std::vector<Conflict>& conflicts() const { return conflicts_; }
  const Settings& settings() const { return settings_; }
  // While a part is called, returns the time of the change that caused the call. Otherwise returns the time
  // of the chip.
  States now() const { return inside_ ? at_ : chip_.now(); }

  // States of the parts. Restore the chip first, then the netlist. The states of chip and netlist must have
  // been saved at the same time. The netlist must still have the same parts.
  struct Saved {
    std::vector<std::vector<double>> parts;
  };
  Saved save() const;
  void restore(const Saved& saved);

  // --- for parts ---------------------------------------------------------------------------------

  // Creates an output of the part on the net and returns the output's index. The output does not drive the
  // net until drive() is called.
  int output(const Part& part, Net net, const std::string& name);
  void listen(Part& part, Net net);
  // Drives the output's net with `voltage` through a resistance of `ohms`. If `moving` is true, the voltage
  // is the result of Part::voltage instead.
  void drive(int output, double voltage, double ohms = 0, bool moving = false);
  void release(int output);
  // Schedules woken() for `at` and replaces an earlier schedule. To cancel the schedule, set `at` to the
  // maximum value of the type States.
  void wake(Part& part, States at);
  // When the moving voltage of an output crosses 0.5, the net changes between low and high. The part must
  // then call touch() for this output. touch() evaluates the output's net again.
  void touch(int output);

 private:
  struct Output {
    const Part* part;
    Net net;
    std::string name;
    bool on = false, moving = false;
    double voltage = 0, ohms = 0;
  };
  struct Node {
    std::string name;
    Net joined;
    std::vector<Pin> pins;
    std::vector<int> outputs;
    std::vector<Part*> listeners;
    std::optional<double> last;
    bool conflict = false, dirty = false;
  };
  struct WakeUp {
    States at;
    int call;
  };
  struct Resolved {
    std::optional<double> voltage;
    std::string first, second;  // conflicting drivers
  };
  Net root(Net n) const;
  void place(Part& part);
  Resolved resolve(const Node& node, std::optional<Pin> without, States at) const;
  void mark(Net n);
  void settle(States at);
  void work(Node& node);
  void push(Node& node);

  Chip& chip_;
  Settings settings_;
  std::deque<Node> nodes_;
  std::map<std::string, Net, std::less<>> names_;
  std::deque<Output> outputs_;
  std::vector<std::unique_ptr<Part>> parts_;
  std::map<Part*, WakeUp> wake_ups_;
  std::map<Pin, Net> pins_;
  std::map<Pin, std::optional<bool>> given_;
  std::vector<int> watches_;
  std::deque<Net> dirty_;
  std::vector<Conflict> conflicts_;
  bool inside_ = false;
  States at_ = 0;
};

// Reads a netlist in text form and adds the parts to `netlist`. Each line describes one part, and `#` starts
// a comment:
// - `pull-up NET OHMS` and `pull-down NET OHMS`.
// - `wire NET NET ...` joins nets.
// - `analog NET SHARE [OHMS]`: SHARE is a fraction of AVCC, 0..1.
// - `switch NET vcc|gnd [closed] [FROM..TO ...]`: a switch from NET to the supply or ground. By default,
//   the switch is normally open: it is closed only during the intervals FROM..TO. With the word `closed`, it
//   is normally closed, and open only during the intervals.
// - `inverter IN OUT [DELAY]`.
// - `open-drain IN OUT`: OUT is low while IN is high.
// - `rc IN OUT OHMS FARADS`.
// - `divider IN OUT OHMS OHMS`: a resistor from IN to OUT, and a resistor from OUT to ground.
// - `probe NET`.
//
// Numbers may end in k, M, m, u, n or p. Times are in states, or in seconds if the text ends in s ("5ms"). An
// error contains `name`, line, column and the expected text; the parts before the error remain in `netlist`.
// load_netlist reads a file of up to 1 MiB.
Result<void> read_netlist(Netlist& netlist, std::string_view text, const std::string& name);
Result<void> load_netlist(Netlist& netlist, const std::string& path);

}  // namespace kaz::h8s
