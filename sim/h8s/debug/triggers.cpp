// Breakpoints and watchpoints on a chip for the duration of one run.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/triggers.h"

namespace kaz::h8s {

const Watch* find_watch(const std::vector<Watch>& watches, const Access& access) {
  for (const Watch& w : watches) {
    if (!(access.write ? w.write : w.read)) continue;
    const std::uint64_t end = std::uint64_t{w.address} + w.size;
    if (access.address < end && w.address < access.address + access.size) return &w;
  }
  return nullptr;
}

ArmedTriggers::ArmedTriggers(Chip& chip, const Triggers& triggers)
    : chip_(chip), triggers_(triggers) {
  const States start = triggers.at_start ? -1 : chip.now();
  for (const std::uint32_t at : triggers.breakpoints) {
    chip.set_hook(
        at, [start](Chip& c) { return c.now() == start ? HookAction::go_on : HookAction::stop; });
  }
  if (!triggers.watches.empty()) chip.attach(*this);
}

ArmedTriggers::~ArmedTriggers() {
  for (const std::uint32_t at : triggers_.breakpoints) chip_.clear_hook(at);
  if (!triggers_.watches.empty()) chip_.detach(*this);
}

void ArmedTriggers::accessed(const Access& access) {
  if (watched_) return;
  if (const Watch* w = find_watch(triggers_.watches, access)) {
    watched_ = Halt{Halt::Why::watch, {}, access.address, *w};
    chip_.request_stop();
  }
}

Halt ArmedTriggers::halt(const Stop& stop) const {
  if (stop.reason == Stop::Reason::reached && !watched_) return {};
  if (stop.reason == Stop::Reason::breakpoint) return {Halt::Why::breakpoint, stop, 0, {}};
  if (watched_ &&
      (stop.reason == Stop::Reason::requested || stop.reason == Stop::Reason::reached)) {
    Halt halt = *watched_;
    halt.stop = stop;
    return halt;
  }
  return {Halt::Why::stopped, stop, 0, {}};
}

NotedTriggers::NotedTriggers(Chip& chip, const Triggers& triggers, States limit)
    : chip_(chip), triggers_(triggers), limit_(limit) {
  for (const std::uint32_t at : triggers.breakpoints) {
    chip.set_hook(at, [this](Chip& c) {
      if (c.now() < limit_) last_ = Hit{c.now(), {Halt::Why::breakpoint, {}, 0, {}}};
      return HookAction::go_on;
    });
  }
  if (!triggers.watches.empty()) chip.attach(*this);
}

NotedTriggers::~NotedTriggers() {
  for (const std::uint32_t at : triggers_.breakpoints) chip_.clear_hook(at);
  if (!triggers_.watches.empty()) chip_.detach(*this);
}

void NotedTriggers::accessed(const Access& access) {
  if (const Watch* w = find_watch(triggers_.watches, access))
    pending_ = Halt{Halt::Why::watch, {}, access.address, *w};
}

void NotedTriggers::settle(States begin) {
  if (pending_ && begin < limit_) last_ = Hit{begin, *pending_};
  pending_.reset();
}

}  // namespace kaz::h8s
