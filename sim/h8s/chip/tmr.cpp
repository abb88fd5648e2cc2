// 8-bit timers: counting, compare matches, outputs, registers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/tmr.h"

#include <algorithm>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {

States Tmr::divisor(const Machine& m, unsigned n) const {
  const unsigned cks = timer_[n].clock_select();
  constexpr States slow[2][4] = {{0, 8, 64, 1024}, {0, 8, 64, 1024}};
  constexpr States fast[2][4] = {{0, 2, 32, 256}, {0, 2, 128, 2048}};
  if (cks > 3) return 0;
  const bool icks = (m.stcr() >> n & 1) != 0;
  return icks ? fast[n][cks] : slow[n][cks];
}

void Tmr::update(Machine& m, unsigned n, States at) {
  const unsigned active = timer_[n].requests();
  m.irq.set_all(n == 0 ? vec::cmia0 : vec::cmia1, 3,
                (active & Timer8::kCmfa ? 1u : 0u) | (active & Timer8::kCmfb ? 2u : 0u) |
                    (active & Timer8::kOvf ? 4u : 0u),
                at);
}

void Tmr::taken_by_dtc(Machine& m, unsigned vector, States at) {
  const unsigned n = vector >= vec::cmia1 ? 1 : 0;
  timer_[n].flags.drop(vector & 1 ? Timer8::kCmfb : Timer8::kCmfa);
  update(m, n, at);
}

Timer8::Crossed Tmr::step(Machine& m, unsigned n, std::int64_t counts, States at) {
  const Timer8::Crossed crossed = timer_[n].step(counts);
  if (crossed.a && n == 0 && (timer_[n].tcsr_low & 0x10)) m.adc.trigger(m, 2, at);
  update(m, n, at);
  return crossed;
}

// TMR0 may count TMR1's overflows, TMR1 TMR0's matches A.
void Tmr::pass_on(Machine& m, unsigned n, Timer8::Crossed crossed, States at) {
  if (n == 1 && crossed.overflow && cascaded(0)) step(m, 0, 1, at);
  if (n == 0 && crossed.a && cascaded(1)) step(m, 1, 1, at);
}

void Tmr::advance_one(Machine& m, unsigned n, States to) {
  const States d = divisor(m, n);
  if (d == 0) return;
  Timer8& t = timer_[n];
  const States target = (to - m.epoch) / d;
  const bool chained = cascaded(1 - n);
  while (t.tick < target) {
    const std::int64_t counts = std::min(t.to_next(), target - t.tick);
    t.tick += counts;
    const States at = m.epoch + t.tick * d;
    const std::uint8_t before = t.flags.value();
    pass_on(m, n, step(m, n, counts, at), at);
    // A long time unobserved.
    if (before == t.flags.value() && !chained) t.skip_turns(target);
  }
}

void Tmr::advance(Machine& m, States to) {
  if (m.stopped(Stop_tmr)) {
    clock_changed(m, to);
    return;
  }
  advance_one(m, 0, to);
  advance_one(m, 1, to);
}

States Tmr::next_event(Machine& m) const {
  States first = kNever;
  for (unsigned n = 0; n < 2; ++n) {
    const States d = divisor(m, n);
    if (d == 0) continue;
    const Timer8& t = timer_[n];
    const unsigned wanted = t.tcr & ~t.flags.value() & 0xe0u;
    const bool triggers = n == 0 && (t.tcsr_low & 0x10);
    const bool feeds = cascaded(1 - n) && (timer_[1 - n].tcr & 0xe0);
    std::int64_t counts = kNever;
    // Whichever comes first may clear the counter, so look at each crossing.
    if (wanted || triggers || feeds) counts = t.to_next();
    if (counts != kNever) first = std::min(first, m.epoch + (t.tick + counts) * d);
  }
  return first;
}

States Tmr::next_change(const Machine& m, unsigned n) const {
  const Timer8& t = timer_[n];
  if (!cascaded(n)) {
    const States d = divisor(m, n);
    const std::int64_t counts = t.to_next_change();
    return d == 0 || counts == kNever ? kNever : m.epoch + (t.tick + counts) * d;
  }
  const Timer8& other = timer_[1 - n];
  const States d = divisor(m, 1 - n);
  return d == 0 || !t.drives() ? kNever : m.epoch + (other.tick + other.to_next()) * d;
}

void Tmr::clock_changed(Machine& m, States at) {
  for (unsigned n = 0; n < 2; ++n) {
    if (const States d = divisor(m, n)) timer_[n].tick = (at - m.epoch) / d;
  }
}

void Tmr::clock_edge(Machine& m, unsigned n, bool rising, States at) {
  if (m.stopped(Stop_tmr) || !timer_[n].counts_edge(rising)) return;
  advance(m, at);
  pass_on(m, n, step(m, n, 1, at), at);
}

void Tmr::reset_edge(Machine& m, unsigned n, bool rising, States at) {
  if (m.stopped(Stop_tmr) || !rising || timer_[n].clear() != Timer8::Clear::on_pin) return;
  advance(m, at);
  timer_[n].count = 0;
}

bool Tmr::waits_for_input() const {
  return std::any_of(timer_.begin(), timer_.end(),
                     [](const Timer8& t) { return t.waits_for_clock(); });
}

// One turn after another from the present level; two turns are a whole number of periods, also of a
// toggle.
double Tmr::high_share(Machine& m, unsigned n) const {
  const Timer8& t = timer_[n];
  if (divisor(m, n) == 0 || m.stopped(Stop_tmr)) return t.level ? 1 : 0;
  const int turn = static_cast<int>(t.turn());
  const int a = t.tcora + 1, b = t.tcorb + 1;  // end of the count that matches
  bool level = t.level;
  int high = 0;
  for (int round = 0; round < 4; ++round) {
    int from = 0;
    const auto run_to = [&](int until, bool on_a, bool on_b) {
      if (level && round >= 2) high += until - from;
      from = until;
      level = timer_output(level, t.tcsr_low & 0x0f, on_a, on_b);
    };
    const int first = std::min(a, b), second = std::max(a, b);
    if (first <= turn) run_to(first, a == first, b == first);
    if (second != first && second <= turn) run_to(second, a == second, b == second);
    run_to(turn, false, false);
  }
  return static_cast<double>(high) / (2 * turn);
}

std::uint8_t Tmr::peek(std::uint32_t address) const {
  const Timer8& t = timer_[address & 1];
  switch (address & ~1u) {
    case 0xffc8:
      return t.tcr;
    case 0xffca:
      return static_cast<std::uint8_t>(t.flags.value() | t.tcsr_low | (address & 1 ? 0x10 : 0));
    case 0xffcc:
      return t.tcora;
    case 0xffce:
      return t.tcorb;
    default:
      return t.count;
  }
}

std::uint8_t Tmr::read(Machine& m, std::uint32_t address, States at) {
  advance(m, at);
  if ((address & ~1u) == 0xffca) timer_[address & 1].flags.read();
  return peek(address);
}

void Tmr::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  const unsigned n = address & 1, which = address & ~1u;
  Timer8& t = timer_[n];
  // Up to the state of the write itself, where a write wins over a count and keeps a match away.
  advance(m, at - 1);
  std::uint8_t* const compare = which == 0xffcc ? &t.tcora : which == 0xffce ? &t.tcorb : nullptr;
  const std::uint8_t before = compare ? *compare : 0;
  if (compare) *compare = static_cast<std::uint8_t>(~t.count);
  if (which != 0xffd0) advance(m, at);
  const bool drove = drives(n);
  bool changed = false;
  const auto put = [&](std::uint8_t& place, std::uint8_t old, std::uint8_t now) {
    changed = old != now;
    place = now;
  };
  switch (which) {
    case 0xffc8:
      put(t.tcr, t.tcr, value);
      break;
    case 0xffca:
      t.flags.write(static_cast<std::uint8_t>(value | 0x1f));
      put(t.tcsr_low, t.tcsr_low, static_cast<std::uint8_t>(value & (n == 0 ? 0x1f : 0x0f)));
      break;
    case 0xffcc:
    case 0xffce:
      put(*compare, before, value);
      break;
    default:
      t.count = value;
      break;
  }
  if (changed || which == 0xffd0) {
    if (const States d = divisor(m, n)) t.tick = (at - m.epoch) / d;
  }
  if (changed && (drove || drives(n))) m.notify(OutputChange::Unit::timer, static_cast<int>(n), at);
  update(m, n, at);
}

}  // namespace kaz::h8s
