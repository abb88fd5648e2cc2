// Reverse execution: snapshots, and replay of the inputs since.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/history.h"

#include <algorithm>
#include <limits>
#include <string>

#include "sim/h8s/debug/triggers.h"

namespace kaz::h8s {
namespace {

constexpr States kEver = std::numeric_limits<States>::max();

bool went_on(const Stop& stop) {
  return stop.reason == Stop::Reason::reached;
}

}  // namespace

// A separate chip that runs from a snapshot with the recorded inputs.
struct History::Player {
  const History& history;
  Chip chip;
  std::size_t next;  // input

  States due() const { return next < history.inputs_.size() ? history.inputs_[next].at : kEver; }
  void feed() {
    while (due() <= chip.now()) history.inputs_[next++].apply(chip);
  }
  Stop run_until(States until) {
    for (;;) {
      feed();
      if (chip.now() >= until) return {};
      const Stop stop = chip.run_until(std::min(until, due()));
      if (!went_on(stop)) return stop;
    }
  }
  // As History::step: sleep is divided at an input or at `limit`.
  Stop step(States limit) {
    feed();
    const Stop stop = chip.step(std::min(limit, due()));
    feed();
    return stop;
  }
};

History::History(Chip& chip, HistoryOptions options) : chip_(chip), options_(options) {
  chip_.set_input_log(this);
  restart();
}

History::~History() {
  chip_.set_input_log(nullptr);
}

States History::begin() const {
  return broken_ ? chip_.now() : snapshots_.front().at;
}
States History::end() const {
  return broken_ ? chip_.now() : std::max(end_, chip_.now());
}
bool History::replaying() const {
  return !broken_ && chip_.now() < end_;
}

void History::restart() {
  snapshots_.clear();
  inputs_.clear();
  samples_.clear();
  cursor_ = 0;
  broken_ = false;
  snapshot();
}

void History::mend() {
  if (broken_) restart();
  end_ = std::max(end_, chip_.now());
}

void History::snapshot() {
  end_ = chip_.now();
  snapshots_.push_back({chip_.now(), inputs_.size(), chip_.save()});
  thin_snapshots();
  forget_past();
}

void History::thin_snapshots() {
  if (snapshots_.size() <= std::max<std::size_t>(options_.snapshots, 3)) return;
  // Drops the snapshot whose removal widens a gap least, relative to its age.
  std::size_t drop = 1;
  double best = 0;
  for (std::size_t k = 1; k + 1 < snapshots_.size(); ++k) {
    const auto gap = static_cast<double>(snapshots_[k + 1].at - snapshots_[k - 1].at);
    const double weight = gap / static_cast<double>(1 + chip_.now() - snapshots_[k].at);
    if (k == 1 || weight < best) {
      best = weight;
      drop = k;
    }
  }
  snapshots_.erase(snapshots_.begin() + static_cast<std::ptrdiff_t>(drop));
}

// The record begins at the oldest snapshot, so it is cut at one.
void History::forget_past() {
  while (snapshots_.size() > 1 && inputs_.size() + samples_.size() > options_.records) {
    snapshots_.erase(snapshots_.begin());
    const Snapshot first = snapshots_.front();
    inputs_.erase(inputs_.begin(), inputs_.begin() + static_cast<std::ptrdiff_t>(first.inputs));
    for (Snapshot& s : snapshots_) s.inputs -= first.inputs;
    cursor_ -= first.inputs;
    std::erase_if(samples_, [&](const Sample& s) { return s.at < first.at; });
  }
}

const History::Snapshot* History::last_before(States at) const {
  const Snapshot* found = nullptr;
  for (const Snapshot& s : snapshots_) {
    if (s.at < at) found = &s;
  }
  return found;
}

void History::forget_future() {
  const States now = chip_.now();
  inputs_.resize(std::min(cursor_, inputs_.size()));
  std::erase_if(snapshots_, [&](const Snapshot& s) { return s.at > now || s.inputs > cursor_; });
  std::erase_if(samples_, [&](const Sample& s) { return s.at > now; });
  end_ = now;
}

void History::input(std::function<void(Chip&)> apply) {
  if (adopting_ || broken_) return;
  if (chip_.now() < end_) forget_future();
  inputs_.push_back({chip_.now(), std::move(apply)});
  cursor_ = inputs_.size();
}

void History::cut() {
  if (!adopting_) broken_ = true;
}

void History::sampled(int channel, States at, double value) {
  if (!adopting_ && !broken_) samples_.push_back({at, channel, value});
}

History::Player History::player(const Snapshot& from) const {
  return player(*from.chip, from.inputs);
}

History::Player History::player(const Chip& from, std::size_t inputs) const {
  Player p{*this, from.clone(), inputs};
  p.chip.set_analog([this](int channel, States at) {
    const auto first = std::lower_bound(samples_.begin(), samples_.end(), at,
                                        [](const Sample& s, States t) { return s.at < t; });
    for (auto s = first; s != samples_.end() && s->at == at; ++s) {
      if (s->channel == channel) return s->value;
    }
    return 0.0;
  });
  return p;
}

void History::adopt(const Player& player) {
  adopting_ = true;
  chip_.restore(player.chip);
  adopting_ = false;
  cursor_ = player.next;
}

Halt History::run_live(States until, const Triggers& triggers) {
  const ArmedTriggers armed(chip_, triggers);
  for (;;) {
    const States next = snapshots_.back().at + options_.spacing;
    if (!broken_ && chip_.now() >= next) {
      snapshot();
      continue;
    }
    const Stop stop = chip_.run_until(broken_ ? until : std::min(until, next));
    mend();
    const Halt halt = armed.halt(stop);
    if (halt.why != Halt::Why::reached || chip_.now() >= until) return halt;
  }
}

Halt History::run_until(States until, const Triggers& triggers) {
  mend();
  if (!replaying()) return run_live(until, triggers);
  const States now = chip_.now();
  Player p = player(chip_, cursor_);
  Halt halt;
  {
    const ArmedTriggers armed(p.chip, triggers);
    halt = armed.halt(p.run_until(std::min(until, end_)));
  }
  adopt(p);
  if (halt.why != Halt::Why::reached || chip_.now() >= until || chip_.now() == now) return halt;
  Triggers rest = triggers;
  rest.at_start = true;
  return run_until(until, rest);
}

Halt History::step() {
  mend();
  if (!replaying()) {
    if (chip_.now() >= snapshots_.back().at + options_.spacing) snapshot();
    const Stop stop = chip_.step();
    mend();
    return {went_on(stop) ? Halt::Why::reached : Halt::Why::stopped, stop, 0, {}};
  }
  Player p = player(chip_, cursor_);
  const Stop stop = p.step(end_);
  adopt(p);
  return {went_on(stop) ? Halt::Why::reached : Halt::Why::stopped, stop, 0, {}};
}

Result<void> History::back_to(States at) {
  mend();
  if (at < begin() || at > end())
    return fail("state " + std::to_string(at) + ": must be in the history, " +
                std::to_string(begin()) + " to " + std::to_string(end()));
  Player p = player(*last_before(at == begin() ? at + 1 : at));
  p.run_until(at);
  adopt(p);
  return {};
}

Halt History::step_back() {
  mend();
  const States here = chip_.now();
  const Snapshot* from = last_before(here);
  if (!from) return {Halt::Why::begin, {}, 0, {}};
  for (States margin = 64;; margin *= 16) {
    const States start = std::max(from->at, here - margin);
    Player p = player(*from);
    p.run_until(start);
    // Inside a long instruction or a sleep: start earlier.
    if (start > from->at && (p.chip.now() >= here || p.chip.asleep())) continue;
    States last = p.chip.now();
    while (p.chip.now() < here) {
      last = p.chip.now();
      if (!went_on(p.step(here)) || p.chip.now() == last) break;
    }
    Player arrived = player(*from);
    arrived.run_until(last);
    adopt(arrived);
    return {};
  }
}

Halt History::reverse_continue(const Triggers& triggers) {
  mend();
  States limit = chip_.now();
  for (const Snapshot* from = last_before(limit); from; from = last_before(limit)) {
    std::optional<NotedTriggers::Hit> hit;
    {
      Player p = player(*from);
      const NotedTriggers noted(p.chip, triggers, limit);
      p.run_until(limit);
      hit = noted.last();
    }
    if (hit) {
      Player arrived = player(*from);
      arrived.run_until(hit->at);
      adopt(arrived);
      return hit->halt;
    }
    limit = from->at;
  }
  adopt(player(snapshots_.front()));
  return {Halt::Why::begin, {}, 0, {}};
}

}  // namespace kaz::h8s
