// A netlist around the chip: nets that join pins, and parts on them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <limits>
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

// Index of a net; several may be the same net after wire().
using Net = int;

// Base class of parts. A part drives nets through outputs (Netlist::output), is notified of changes on
// nets that it listens to, and can schedule a call (Netlist::wake). Its reactions take effect at the
// same state.
class Part {
 public:
  virtual ~Part() = default;
  // Called once when the part is added, and after Netlist::restore.
  virtual void start(Netlist&, States) {}
  // The voltage or the drive of a net that it listens to changes at `at`.
  virtual void changed(Netlist&, Net, States /*at*/) {}
  virtual void woken(Netlist&, States /*at*/) {}
  // For outputs whose voltage moves between edges (Netlist::drive with `moving`): as a share of
  // AVCC.
  virtual double voltage(States /*at*/) const { return 0; }
  // The part's state, for Netlist::save and restore.
  virtual std::vector<double> save() const { return {}; }
  virtual void restore(std::span<const double>) {}
};

// Two strong drivers with different levels, or a loop that does not settle.
struct Conflict {
  std::string net, first, second;
  States at = 0;
  std::string text() const;
};

// Voltages are shares of AVCC: 0 is ground, 1 is the supply; a net is high from 0.5 on.
class Netlist {
 public:
  struct Settings {
    std::int64_t hertz = 18'432'000;  // states per second
    double pull_up_ohms = 50'000;     // the chip's own pull-ups
    double weak_high_ohms = 1'000;    // high level of NMOS push-pull outputs (P47, P52)
  };
  // Watches the pins that are on nets, drives those that others drive, and is the chip's analog source.
  // `chip` must outlive this and must not be moved.
  explicit Netlist(Chip& chip);
  Netlist(Chip& chip, const Settings& settings);
  ~Netlist();
  Netlist(const Netlist&) = delete;
  Netlist& operator=(const Netlist&) = delete;

  // The net of a pin by any of its names, "vcc", "gnd", or a net of that name, created if new.
  Net net(std::string_view name);
  // Joins two nets into one.
  void wire(Net a, Net b);
  // Adds a part, which the netlist owns.
  template <class P>
  P& add(std::unique_ptr<P> part) {
    P& p = *part;
    parts_.push_back(std::move(part));
    place(p);
    return p;
  }
  // A constant voltage behind a resistance; 0 ohms is a strong drive.
  void source(Net net, double voltage, double ohms, const std::string& name);
  void pull_up(Net net, double ohms) { source(net, 1, ohms, "pull-up"); }
  void pull_down(Net net, double ohms) { source(net, 0, ohms, "pull-down"); }
  // Source for analog inputs that are on no net.
  void set_analog_otherwise(std::function<double(int channel, States at)> source);

  // Fraction of AVCC; nullopt if nothing drives. Strong drives override; the others are averaged,
  // weighted by conductance.
  std::optional<double> voltage(Net net, States at) const;
  bool level(Net net) const;
  const std::vector<Conflict>& conflicts() const { return conflicts_; }
  const Settings& settings() const { return settings_; }
  States now() const { return inside_ ? at_ : chip_.now(); }

  // The parts' states. Restore the chip first, then the netlist, both saved at the same time.
  struct Saved {
    std::vector<std::vector<double>> parts;
  };
  Saved save() const;
  void restore(const Saved& saved);

  // --- for parts ---------------------------------------------------------------------------------
  // Creates an output of the part onto the net, not driving at first.
  int output(const Part& part, Net net, const std::string& name);
  void listen(Part& part, Net net);
  void drive(int output, double voltage, double ohms = 0, bool moving = false);
  void release(int output);
  // Schedules woken() at that time, replacing an earlier schedule.
  void wake(Part& part, States at);
  // A moving voltage has crossed the threshold: evaluates its net again.
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
    std::string first, second;  // of a conflict
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
  std::function<double(int, States)> otherwise_;
  bool inside_ = false;
  States at_ = 0;
};

// Reads the text form into `netlist`: one part a line, `#` starts a comment.
//   pull-up NET OHMS            pull-down NET OHMS
//   wire NET NET ...            analog NET SHARE [OHMS]       (share of AVCC, 0..1)
//   switch NET vcc|gnd [closed] [FROM..TO ...]                (closed, or open, from state to state)
//   inverter IN OUT [DELAY]     open-drain IN OUT             (low while IN is high)
//   rc IN OUT OHMS FARADS       divider IN OUT OHMS OHMS      (to OUT, from OUT to ground)
//   probe NET
// Numbers take k, M, m, u, n and p; times are states or end in s ("5ms"). `name` is for errors, which
// contain file, line, column and what is expected. Parts before the error are added.
Result<void> read_netlist(Netlist& netlist, std::string_view text, const std::string& name);
Result<void> load_netlist(Netlist& netlist, const std::string& path);

}  // namespace kaz::h8s
