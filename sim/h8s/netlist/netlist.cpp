// Nets: their drivers, the levels at the pins, and the order in which changes propagate.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/netlist/netlist.h"

#include <algorithm>

namespace kaz::h8s {
namespace {

// Limit of changes that cause each other within one state; beyond it the loop does not settle.
constexpr int kMaxChanges = 10'000;
constexpr std::size_t kMaxConflicts = 1000;
constexpr double kThreshold = 0.5;

}  // namespace

std::string Conflict::text() const {
  if (second.empty())
    return "net " + net + " does not settle at state " + std::to_string(at) +
           ", because of a loop without delay; the last driver of the net was " + first;
  return "net " + net + " is driven both high and low from state " + std::to_string(at) +
         " on: by " + first + " and by " + second;
}

Netlist::Netlist(Chip& chip) : Netlist(chip, Settings{}) {}

Netlist::Netlist(Chip& chip, const Settings& settings) : chip_(chip), settings_(settings) {
  source(net("vcc"), 1, 0, "vcc");
  source(net("gnd"), 0, 0, "gnd");
  chip_.set_analog([this](int channel, States at) {
    const auto pin = channel < 8 ? pin_of(7, channel) : pin_of(6, channel - 8);
    const auto found = pin ? pins_.find(*pin) : pins_.end();
    if (found == pins_.end()) return 0.0;
    return voltage(found->second, at).value_or(0);
  });
}

Netlist::~Netlist() {
  for (const int id : watches_) chip_.unwatch(id);
  for (const auto& [part, wake_up] : wake_ups_) chip_.cancel(wake_up.call);
  chip_.set_analog(nullptr);
}

Net Netlist::net(std::string_view name) {
  const auto pin = find_pin(name);
  const std::string key(pin ? info(*pin).name() : name);
  if (const auto found = names_.find(key); found != names_.end()) return found->second;
  const Net n = static_cast<Net>(nodes_.size());
  nodes_.push_back({key, n, {}, {}, {}, {}, false, false});
  names_[key] = n;
  if (pin) {
    nodes_.back().pins.push_back(*pin);
    pins_[*pin] = n;
    watches_.push_back(chip_.watch(
        *pin,
        [this, n](const PinEdge& e) {
          mark(n);
          settle(e.at);
        },
        true));
    mark(n);
    settle(now());
  }
  return n;
}

Net Netlist::root(Net n) const {
  while (nodes_[static_cast<std::size_t>(n)].joined != n)
    n = nodes_[static_cast<std::size_t>(n)].joined;
  return n;
}

void Netlist::wire(Net a, Net b) {
  a = root(a), b = root(b);
  if (a == b) return;
  Node& to = nodes_[static_cast<std::size_t>(a)];
  Node& from = nodes_[static_cast<std::size_t>(b)];
  from.joined = a;
  to.name += "/" + from.name;
  to.pins.insert(to.pins.end(), from.pins.begin(), from.pins.end());
  to.outputs.insert(to.outputs.end(), from.outputs.begin(), from.outputs.end());
  to.listeners.insert(to.listeners.end(), from.listeners.begin(), from.listeners.end());
  to.last = std::numeric_limits<double>::infinity();  // no voltage: notifies the listeners of both
  mark(a);
  settle(now());
}

void Netlist::place(Part& part) {
  part.start(*this, now());
  settle(now());
}

void Netlist::source(Net net, double voltage, double ohms, const std::string& name) {
  class Source : public Part {};
  Part& part = add(std::make_unique<Source>());
  drive(output(part, net, name), voltage, ohms);
}

int Netlist::output(const Part& part, Net net, const std::string& name) {
  // A part that is started again keeps its outputs.
  for (std::size_t k = 0; k < outputs_.size(); ++k) {
    if (outputs_[k].part == &part && outputs_[k].net == net && outputs_[k].name == name)
      return static_cast<int>(k);
  }
  outputs_.push_back({&part, net, name, false, false, 0, 0});
  nodes_[static_cast<std::size_t>(root(net))].outputs.push_back(static_cast<int>(outputs_.size()) -
                                                                1);
  return static_cast<int>(outputs_.size()) - 1;
}

void Netlist::listen(Part& part, Net net) {
  auto& listeners = nodes_[static_cast<std::size_t>(root(net))].listeners;
  if (std::find(listeners.begin(), listeners.end(), &part) == listeners.end())
    listeners.push_back(&part);
}

void Netlist::drive(int output, double voltage, double ohms, bool moving) {
  Output& o = outputs_[static_cast<std::size_t>(output)];
  if (o.on && !moving && o.voltage == voltage && o.ohms == ohms) return;
  o.on = true;
  o.moving = moving;
  o.voltage = voltage;
  o.ohms = ohms;
  touch(output);
}

void Netlist::release(int output) {
  Output& o = outputs_[static_cast<std::size_t>(output)];
  if (!o.on) return;
  o.on = false;
  touch(output);
}

void Netlist::touch(int output) {
  mark(outputs_[static_cast<std::size_t>(output)].net);
  settle(now());
}

void Netlist::wake(Part& part, States at) {
  if (const auto old = wake_ups_.find(&part); old != wake_ups_.end()) {
    if (old->second.at == at) return;
    chip_.cancel(old->second.call);
    wake_ups_.erase(old);
  }
  if (at == std::numeric_limits<States>::max()) return;
  const int call = chip_.call_at(at, [this, &part](States when) {
    wake_ups_.erase(&part);
    const bool outer = !std::exchange(inside_, true);
    at_ = when;
    part.woken(*this, when);
    if (outer) inside_ = false;
    settle(when);
  });
  wake_ups_[&part] = {at, call};
}

// All drivers, except the chip's own drive of one pin.
Netlist::Resolved Netlist::resolve(const Node& node, std::optional<Pin> without, States at) const {
  Resolved r;
  std::optional<double> strong;
  double conductance = 0, current = 0;
  const auto add = [&](double volts, double ohms, const auto& name) {
    if (ohms > 0) {
      conductance += 1 / ohms;
      current += volts / ohms;
    } else if (!strong) {
      strong = volts;
      r.first = name();
    } else if (*strong != volts && r.second.empty()) {
      r.second = name();
      strong = std::min(*strong, volts);  // low wins, as outputs sink more than they source
    }
  };
  for (const Pin pin : node.pins) {
    if (pin == without) continue;
    const PinState s = chip_.state(pin);
    if (s.output() && s.driver != Driver::clock)
      add(s.level ? 1 : 0, s.level && info(pin).weak_high ? settings_.weak_high_ohms : 0,
          [&] { return std::string(info(pin).name()) + " (" + std::string(name(s.driver)) + ")"; });
    else if (s.pull_up && !s.output())
      add(1, settings_.pull_up_ohms, [] { return std::string(); });
  }
  for (const int k : node.outputs) {
    const Output& o = outputs_[static_cast<std::size_t>(k)];
    if (o.on) add(o.moving ? o.part->voltage(at) : o.voltage, o.ohms, [&] { return o.name; });
  }
  if (strong)
    r.voltage = strong;
  else if (conductance > 0)
    r.voltage = current / conductance;
  return r;
}

std::optional<double> Netlist::voltage(Net net, States at) const {
  return resolve(nodes_[static_cast<std::size_t>(root(net))], std::nullopt, at).voltage;
}

bool Netlist::level(Net net) const {
  return voltage(net, now()).value_or(0) >= kThreshold;
}

void Netlist::mark(Net n) {
  Node& node = nodes_[static_cast<std::size_t>(root(n))];
  if (std::exchange(node.dirty, true)) return;
  dirty_.push_back(root(n));
}

void Netlist::settle(States at) {
  if (inside_) return;  // whoever works takes it up
  inside_ = true;
  at_ = at;
  int changes = 0;
  while (!dirty_.empty()) {
    Node& node = nodes_[static_cast<std::size_t>(root(dirty_.front()))];
    dirty_.pop_front();
    node.dirty = false;
    if (++changes > kMaxChanges) {
      if (conflicts_.size() < kMaxConflicts)
        conflicts_.push_back({node.name, resolve(node, std::nullopt, at).first, {}, at});
      for (const Net n : dirty_) nodes_[static_cast<std::size_t>(root(n))].dirty = false;
      dirty_.clear();
      break;
    }
    work(node);
  }
  inside_ = false;
}

void Netlist::work(Node& node) {
  const Resolved r = resolve(node, std::nullopt, at_);
  if (!r.second.empty() && !node.conflict && conflicts_.size() < kMaxConflicts)
    conflicts_.push_back({node.name, r.first, r.second, at_});
  node.conflict = !r.second.empty();
  push(node);
  if (r.voltage == node.last) return;
  node.last = r.voltage;
  const std::vector<Part*> listeners = node.listeners;
  for (Part* part : listeners) part->changed(*this, node.joined, at_);
}

// Drives each pin by the others on its net, so that a pin that stops driving has the right level.
void Netlist::push(Node& node) {
  for (const Pin pin : node.pins) {
    const auto others = resolve(node, pin, at_).voltage;
    std::optional<bool> level;
    if (others) level = *others >= kThreshold;
    // An internal pull-up against an external resistor.
    const PinState s = chip_.state(pin);
    if (others && s.pull_up && !s.output())
      level = resolve(node, std::nullopt, at_).voltage.value_or(0) >= kThreshold;
    const auto known = given_.find(pin);
    if (known != given_.end() && known->second == level) continue;
    if (known == given_.end() && !level) continue;
    given_[pin] = level;
    if (level)
      chip_.set_input(pin, *level);
    else
      chip_.release_input(pin);
  }
}

Netlist::Saved Netlist::save() const {
  Saved saved;
  for (const auto& part : parts_) saved.parts.push_back(part->save());
  return saved;
}

void Netlist::restore(const Saved& saved) {
  for (const auto& [part, wake_up] : wake_ups_) chip_.cancel(wake_up.call);
  wake_ups_.clear();
  given_.clear();
  inside_ = true;
  at_ = chip_.now();
  for (std::size_t k = 0; k < parts_.size() && k < saved.parts.size(); ++k) {
    parts_[k]->restore(saved.parts[k]);
    parts_[k]->start(*this, at_);
  }
  inside_ = false;
  for (std::size_t k = 0; k < nodes_.size(); ++k) mark(static_cast<Net>(k));
  settle(chip_.now());
}

}  // namespace kaz::h8s
