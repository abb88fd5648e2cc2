// Parts: switches, gates, resistors and capacitors, probes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/netlist/parts.h"

#include <algorithm>
#include <cmath>

namespace kaz::h8s {

void Switch::start(Netlist& n, States at) {
  output_ = n.output(*this, net_, to_supply_ ? "switch to vcc" : "switch to gnd");
  plan(n, at);
  set(n, closed_);
}

void Switch::set(Netlist& n, bool closed) {
  closed_ = closed;
  if (closed)
    n.drive(output_, to_supply_ ? 1 : 0);
  else
    n.release(output_);
}

void Switch::set_at(Netlist& n, States at, bool closed) {
  schedule_.emplace_back(at, closed);
  plan(n, n.now() - 1);
}

void Switch::plan(Netlist& n, States at) {
  const auto next = std::find_if(schedule_.begin(), schedule_.end(),
                                 [at](const auto& entry) { return entry.first > at; });
  n.wake(*this, next == schedule_.end() ? std::numeric_limits<States>::max() : next->first);
}

void Switch::woken(Netlist& n, States at) {
  for (const auto& [when, closed] : schedule_) {
    if (when == at) set(n, closed);
  }
  plan(n, at);
}

void Inverter::start(Netlist& n, States at) {
  output_ = n.output(*this, out_, "inverter");
  n.listen(*this, in_);
  if (under_way_.empty()) {
    wanted_ = shown_ = !n.level(in_);
  } else {
    n.wake(*this, std::max(at, under_way_.front().first));
  }
  n.drive(output_, shown_ ? 1 : 0);
}

void Inverter::changed(Netlist& n, Net, States at) {
  const bool level = !n.level(in_);
  if (level == wanted_) return;
  wanted_ = level;
  if (delay_ == 0) {
    shown_ = level;
    n.drive(output_, level ? 1 : 0);
    return;
  }
  under_way_.emplace_back(at + delay_, level);
  if (under_way_.size() == 1) n.wake(*this, under_way_.front().first);
}

void Inverter::woken(Netlist& n, States at) {
  while (!under_way_.empty() && under_way_.front().first <= at) {
    shown_ = under_way_.front().second;
    under_way_.pop_front();
  }
  n.drive(output_, shown_ ? 1 : 0);
  if (!under_way_.empty()) n.wake(*this, under_way_.front().first);
}

std::vector<double> Inverter::save() const {
  std::vector<double> values{wanted_ ? 1.0 : 0.0, shown_ ? 1.0 : 0.0};
  for (const auto& [at, level] : under_way_) {
    values.push_back(static_cast<double>(at));
    values.push_back(level ? 1 : 0);
  }
  return values;
}

void Inverter::restore(std::span<const double> values) {
  wanted_ = values[0] != 0;
  shown_ = values[1] != 0;
  under_way_.clear();
  for (std::size_t k = 2; k + 1 < values.size(); k += 2)
    under_way_.emplace_back(static_cast<States>(values[k]), values[k + 1] != 0);
}

void OpenDrain::start(Netlist& n, States at) {
  output_ = n.output(*this, out_, "open drain");
  n.listen(*this, in_);
  changed(n, in_, at);
}

void OpenDrain::changed(Netlist& n, Net, States) {
  if (n.level(in_))
    n.drive(output_, 0);
  else
    n.release(output_);
}

void Rc::start(Netlist& n, States at) {
  tau_ = ohms_ * farads_ * static_cast<double>(n.settings().hertz);
  const bool again = output_ >= 0;
  output_ = n.output(*this, out_, "rc");
  n.listen(*this, in_);
  if (!again) since_ = at;
  n.drive(output_, 0, ohms_, true);
  if (again)
    plan(n, at);
  else
    changed(n, in_, at);
}

double Rc::voltage(States at) const {
  if (!driven_) return from_;
  return to_ + (from_ - to_) * std::exp(-static_cast<double>(at - since_) / tau_);
}

void Rc::changed(Netlist& n, Net, States at) {
  const auto in = n.voltage(in_, at);
  if (in.has_value() == driven_ && (!in || *in == to_)) return;
  from_ = voltage(at);
  since_ = at;
  driven_ = in.has_value();
  if (in) to_ = *in;
  plan(n, at);
}

// Wakes when the output crosses the threshold of a digital input.
void Rc::plan(Netlist& n, States at) {
  const double now = voltage(at);
  const bool crosses = driven_ && (now >= 0.5) != (to_ >= 0.5) && to_ != 0.5;
  if (!crosses) return n.wake(*this, std::numeric_limits<States>::max());
  const double left = tau_ * std::log((now - to_) / (0.5 - to_));
  n.wake(*this, at + std::max<States>(1, static_cast<States>(std::ceil(std::min(left, 1e15)))));
}

void Rc::woken(Netlist& n, States at) {
  n.touch(output_);
  plan(n, at);
}

std::vector<double> Rc::save() const {
  return {from_, to_, driven_ ? 1.0 : 0.0, static_cast<double>(since_)};
}

void Rc::restore(std::span<const double> values) {
  from_ = values[0];
  to_ = values[1];
  driven_ = values[2] != 0;
  since_ = static_cast<States>(values[3]);
}

void Divider::start(Netlist& n, States at) {
  output_ = n.output(*this, out_, "divider");
  n.listen(*this, in_);
  changed(n, in_, at);
}

// Source resistance at the output: both resistors in parallel.
void Divider::changed(Netlist& n, Net, States at) {
  const auto in = n.voltage(in_, at);
  if (in)
    n.drive(output_, *in * lower_ / (upper_ + lower_), upper_ * lower_ / (upper_ + lower_));
  else
    n.drive(output_, 0, lower_);
}

void Probe::start(Netlist& n, States at) {
  n.listen(*this, net_);
  const bool level = n.level(net_);
  std::erase_if(levels_, [at](const auto& entry) { return entry.first > at; });
  if (!placed_ || levels_.empty()) levels_.emplace_back(at, level);
  placed_ = true;
}

void Probe::changed(Netlist& n, Net, States at) {
  const bool level = n.level(net_);
  if (levels_.back().second == level) return;
  if (levels_.back().first == at && levels_.size() > 1) return levels_.pop_back();
  levels_.emplace_back(at, level);
}

double Probe::high_share(States from, States to) const {
  if (to <= from) return 0;
  States high = 0;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const States begin = std::max(from, levels_[k].first);
    const States end = std::min(to, k + 1 < levels_.size() ? levels_[k + 1].first : to);
    if (levels_[k].second && end > begin) high += end - begin;
  }
  return static_cast<double>(high) / static_cast<double>(to - from);
}

}  // namespace kaz::h8s
