// 8-bit timers: counting, compare matches, outputs, registers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/tmr.h"

#include <algorithm>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

constexpr std::uint8_t kOvf = 0x20, kCmfa = 0x40, kCmfb = 0x80;

std::int64_t distance(unsigned count, unsigned value) {
  return static_cast<std::int64_t>((value - count) & 0xff) + 1;
}

// Output selection: 0 keep, 1 low, 2 high, 3 toggle.
bool apply_output(bool level, unsigned action) {
  return action == 3 ? !level : action == 2 ? true : action == 1 ? false : level;
}

// Both matches at once: toggle before high before low before none.
bool output_after(bool level, std::uint8_t os, bool a, bool b) {
  const unsigned on_a = a ? os & 3u : 0, on_b = b ? os >> 2 & 3u : 0;
  return apply_output(level, std::max(on_a, on_b));
}

}  // namespace

States Tmr::divisor(const Machine& m, unsigned n) const {
  const unsigned cks = timer_[n].tcr & 7u;
  constexpr States slow[2][4] = {{0, 8, 64, 1024}, {0, 8, 64, 1024}};
  constexpr States fast[2][4] = {{0, 2, 32, 256}, {0, 2, 128, 2048}};
  if (cks > 3) return 0;
  const bool icks = (m.stcr() >> n & 1) != 0;
  return icks ? fast[n][cks] : slow[n][cks];
}

std::int64_t Tmr::to_next(const Timer& t) const {
  return std::min(
      {distance(t.count, t.tcora), distance(t.count, t.tcorb), distance(t.count, 0xff)});
}

void Tmr::update(Machine& m, unsigned n, States at) {
  const Timer& t = timer_[n];
  const unsigned active = t.flags.value() & t.tcr;  // enables stand at the flags' places: B A OVF
  const unsigned base = n == 0 ? vec::cmia0 : vec::cmia1;
  m.irq.set_all(base, 3,
                (active & kCmfa ? 1u : 0u) | (active & kCmfb ? 2u : 0u) | (active & kOvf ? 4u : 0u),
                at);
}

Tmr::Crossed Tmr::step(Machine& m, unsigned n, std::int64_t counts, States at) {
  Timer& t = timer_[n];
  const bool a = counts == distance(t.count, t.tcora), b = counts == distance(t.count, t.tcorb);
  const unsigned clear = t.tcr >> 3 & 3u;
  const bool clears = (a && clear == 1) || (b && clear == 2);
  const bool wraps = counts == distance(t.count, 0xff) && !clears;
  t.count = static_cast<std::uint8_t>(t.count + counts);
  if (clears) t.count = 0;
  if (a) t.flags.raise(kCmfa);
  if (b) t.flags.raise(kCmfb);
  if (wraps) t.flags.raise(kOvf);
  t.level = output_after(t.level, t.tcsr_low & 0x0f, a, b);
  if (a && n == 0 && (t.tcsr_low & 0x10)) m.adc.trigger(m, 2, at);
  update(m, n, at);
  return {a, wraps};
}

// TMR0 may count TMR1's overflows, TMR1 TMR0's matches A.
void Tmr::pass_on(Machine& m, unsigned n, Crossed crossed, States at) {
  if (n == 1 && crossed.overflow && cascaded(0)) step(m, 0, 1, at);
  if (n == 0 && crossed.a && cascaded(1)) step(m, 1, 1, at);
}

void Tmr::advance_one(Machine& m, unsigned n, States to) {
  const States d = divisor(m, n);
  if (d == 0) return;
  Timer& t = timer_[n];
  const States target = (to - m.epoch) / d;
  const bool chained = cascaded(1 - n);
  while (t.tick < target) {
    const std::int64_t counts = std::min<std::int64_t>(to_next(t), target - t.tick);
    t.tick += counts;
    const States at = m.epoch + t.tick * d;
    const std::uint8_t before = t.flags.value();
    pass_on(m, n, step(m, n, counts, at), at);
    // A long time unobserved: whole turns change nothing once every flag that can be is set.
    // Toggled outputs repeat after two turns.
    const unsigned clear = t.tcr >> 3 & 3u;
    const std::int64_t turn = clear == 1 ? t.tcora + 1 : clear == 2 ? t.tcorb + 1 : 0x100;
    if (before == t.flags.value() && !chained && t.count < turn && target - t.tick > 3 * turn)
      t.tick += (target - t.tick - turn) / (2 * turn) * 2 * turn;
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
    const Timer& t = timer_[n];
    const unsigned wanted = t.tcr & ~t.flags.value() & 0xe0u;
    const bool triggers = n == 0 && (t.tcsr_low & 0x10);
    const bool feeds = cascaded(1 - n) && (timer_[1 - n].tcr & 0xe0);
    std::int64_t counts = kNever;
    // Whichever comes first may clear the counter, so look at each crossing.
    if (wanted || triggers || feeds) counts = to_next(t);
    if (counts != kNever) first = std::min(first, m.epoch + (t.tick + counts) * d);
  }
  return first;
}

void Tmr::clock_changed(Machine& m, States at) {
  for (unsigned n = 0; n < 2; ++n) {
    if (const States d = divisor(m, n)) timer_[n].tick = (at - m.epoch) / d;
  }
}

void Tmr::clock_edge(Machine& m, unsigned n, bool rising, States at) {
  const unsigned cks = timer_[n].tcr & 7u;
  if (m.stopped(Stop_tmr) || !(cks == 7 || cks == (rising ? 5u : 6u))) return;
  advance(m, at);
  pass_on(m, n, step(m, n, 1, at), at);
}

void Tmr::reset_edge(Machine& m, unsigned n, bool rising, States at) {
  if (m.stopped(Stop_tmr) || !rising || (timer_[n].tcr >> 3 & 3) != 3) return;
  advance(m, at);
  timer_[n].count = 0;
}

bool Tmr::waits_for_input() const {
  return std::any_of(timer_.begin(), timer_.end(),
                     [](const Timer& t) { return (t.tcr & 7) > 4 && (t.tcr & 0xe0); });
}

// One turn after another from the present level; two turns are a whole number of periods, also of a
// toggle.
double Tmr::high_share(Machine& m, unsigned n) const {
  const Timer& t = timer_[n];
  if (divisor(m, n) == 0 || m.stopped(Stop_tmr)) return t.level ? 1 : 0;
  const unsigned clear = t.tcr >> 3 & 3u;
  const int turn = clear == 1 ? t.tcora + 1 : clear == 2 ? t.tcorb + 1 : 0x100;
  const int a = t.tcora + 1, b = t.tcorb + 1;  // end of the count that matches
  bool level = t.level;
  int high = 0;
  for (int round = 0; round < 4; ++round) {
    int from = 0;
    const auto run_to = [&](int until, bool on_a, bool on_b) {
      if (level && round >= 2) high += until - from;
      from = until;
      level = output_after(level, t.tcsr_low & 0x0f, on_a, on_b);
    };
    const int first = std::min(a, b), second = std::max(a, b);
    if (first <= turn) run_to(first, a == first, b == first);
    if (second != first && second <= turn) run_to(second, a == second, b == second);
    run_to(turn, false, false);
  }
  return static_cast<double>(high) / (2 * turn);
}

std::uint8_t Tmr::peek(std::uint32_t address) const {
  const Timer& t = timer_[address & 1];
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
  advance(m, at);
  const unsigned n = address & 1;
  Timer& t = timer_[n];
  const bool drove = drives(n);
  std::uint8_t* changed = nullptr;
  switch (address & ~1u) {
    case 0xffc8:
      changed = &t.tcr;
      break;
    case 0xffca:
      t.flags.write(static_cast<std::uint8_t>(value | 0x1f));
      value = static_cast<std::uint8_t>(value & (n == 0 ? 0x1f : 0x0f));
      changed = &t.tcsr_low;
      break;
    case 0xffcc:
      changed = &t.tcora;
      break;
    case 0xffce:
      changed = &t.tcorb;
      break;
    default:
      t.count = value;
      break;
  }
  if (changed && *changed != value) {
    *changed = value;
    if (const States d = divisor(m, n)) t.tick = (at - m.epoch) / d;
    if (drove || drives(n)) m.notify(OutputChange::Unit::timer, static_cast<int>(n), at);
  }
  update(m, n, at);
}

}  // namespace kaz::h8s
