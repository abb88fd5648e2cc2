// 8-bit timers: counting, compare matches, outputs, registers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/tmr.h"

#include <algorithm>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

// States per count, by STCR.ICKS, timer and clock selection.
constexpr States kDivisors[2][2][4] = {{{0, 8, 64, 1024}, {0, 8, 64, 1024}},
                                       {{0, 2, 32, 256}, {0, 2, 128, 2048}}};

// Counts up to `target` at once where no flag can be raised any more and no output toggles. False: not here.
bool count_quietly(Timer8& t, States target) {
  using Clear = Timer8::Clear;
  const std::int64_t counts = target - t.tick, one = t.turn();
  const bool wraps = t.clear() == Clear::none || t.clear() == Clear::on_pin;
  const bool toggles = t.toggles();
  if (!t.flags.has(TMR_TCSR::CMFA) || !t.flags.has(TMR_TCSR::CMFB) ||
      (wraps && !t.flags.has(TMR_TCSR::OVF)) || toggles || t.count >= one || counts <= 0)
    return false;
  const std::int64_t end = (t.count + counts) % one;
  // Counts since the last match of each, whose effect is that of all before; `counts`: there was none.
  const auto since = [&](std::uint8_t compare) {
    return compare >= one ? counts : std::min((end - compare - 1 + one) % one, counts);
  };
  const std::int64_t a = since(t.tcora), b = since(t.tcorb);
  const std::uint8_t selection = t.tcsr_low & TMR_TCSR::OS;
  if (std::max(a, b) < counts && a != b) t.level = timer_output(t.level, selection, a > b, b > a);
  if (const std::int64_t last = std::min(a, b); last < counts)
    t.level = timer_output(t.level, selection, a == last, b == last);
  t.count = static_cast<std::uint8_t>(end);
  t.tick = target;
  return true;
}

}  // namespace

States Tmr::divisor(const Machine& m, unsigned n) const {
  const unsigned cks = timer_[n].clock_select();
  return cks > 3 ? 0 : kDivisors[m.stcr() >> n & STCR::ICKS0][n][cks];
}

void Tmr::update(Machine& m, unsigned n, States at) {
  const unsigned active = timer_[n].requests();
  m.irq.set_all(n == 0 ? vec::kCmia0 : vec::kCmia1, 3,
                (active & TMR_TCSR::CMFA ? 1u : 0u) | (active & TMR_TCSR::CMFB ? 2u : 0u) |
                    (active & TMR_TCSR::OVF ? 4u : 0u),
                at);
}

void Tmr::taken_by_dtc(Machine& m, unsigned vector, States at) {
  const unsigned n = vector >= vec::kCmia1 ? 1 : 0;
  timer_[n].flags.drop(vector & 1 ? TMR_TCSR::CMFB : TMR_TCSR::CMFA);
  update(m, n, at);
}

void Tmr::matched_a0(Machine& m, States at) {
  if (timer_[0].tcsr_low & TMR_TCSR::ADTE) m.adc.trigger(m, 2, at);
  // Compare match count mode.
  if (cascaded(1)) {
    timer_[1].step(1);
    update(m, 1, at);
  }
}

void Tmr::step(Machine& m, unsigned n, std::int64_t counts, States at) {
  if (n == 1 && cascaded(0)) return step_pair(m, counts, at);
  const std::uint8_t flags = timer_[n].flags.value();
  const Timer8::Crossed crossed = timer_[n].step(counts);
  if (timer_[n].flags.value() != flags) update(m, n, at);
  if (n == 0 && crossed.a) matched_a0(m, at);
}

// 16-bit count mode: TCNT0 is the upper byte. TMR0's matches, output and clear use both bytes, and
// its clear also clears TCNT1; TMR1's matches and output use the lower byte, its CCLR is ignored.
void Tmr::step_pair(Machine& m, std::int64_t counts, States at) {
  Timer8 &upper = timer_[0], &lower = timer_[1];
  const std::uint8_t flags = lower.flags.value();
  const Timer8::Crossed low = lower.step(counts, Timer8::Clear::none);
  const bool a = low.a && upper.count == upper.tcora, b = low.b && upper.count == upper.tcorb;
  const bool clears =
      (a && upper.clear() == Timer8::Clear::on_a) || (b && upper.clear() == Timer8::Clear::on_b);
  if (clears) {
    upper.count = lower.count = 0;
    if (low.overflow && !(flags & TMR_TCSR::OVF)) lower.flags.drop(TMR_TCSR::OVF);
  } else if (low.overflow && ++upper.count == 0) {
    upper.flags.raise(TMR_TCSR::OVF);
  }
  upper.matched(a, b);
  update(m, 0, at);
  update(m, 1, at);
  if (a) matched_a0(m, at);
}

void Tmr::advance_one(Machine& m, unsigned n, States to) {
  const States d = divisor(m, n);
  if (d == 0) return;
  Timer8& t = timer_[n];
  const States target = (to - m.epoch) / d;
  const bool chained = cascaded(1 - n), triggers = n == 0 && (t.tcsr_low & TMR_TCSR::ADTE);
  if (!chained && !triggers && count_quietly(t, target)) return;
  while (t.tick < target) {
    const std::int64_t counts = std::min(t.to_next(), target - t.tick);
    t.tick += counts;
    const States at = m.epoch + t.tick * d;
    const std::uint8_t before = t.flags.value();
    step(m, n, counts, at);
    // Long time without an access.
    if (before == t.flags.value() && !chained) t.skip_turns(target);
  }
}

void Tmr::advance(Machine& m, States to) {
  if (m.stopped(kStopTmr)) {
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
    const unsigned wanted = t.tcr & ~t.flags.value() & Timer8::kFlags;
    const bool triggers = n == 0 && (t.tcsr_low & TMR_TCSR::ADTE);
    const Timer8& fed = timer_[1 - n];
    const bool feeds = cascaded(1 - n) &&
                       ((fed.tcr & Timer8::kFlags) || (n == 1 && (fed.tcsr_low & TMR_TCSR::ADTE)));
    std::int64_t counts = kNever;
    // Either may clear the counter first, so every crossing is checked.
    if (wanted || triggers || feeds) counts = t.to_next();
    if (counts != kNever) first = std::min(first, m.epoch + (t.tick + counts) * d);
  }
  return first;
}

States Tmr::next_change(const Machine& m, unsigned n) const {
  const Timer8& t = timer_[n];
  const unsigned clocked = cascaded(n) ? 1 - n : n;
  const States d = divisor(m, clocked);
  if (d == 0 || !t.drives()) return kNever;
  const Timer8& counter = timer_[clocked];
  // In a cascade any crossing of the clocked timer may be the one.
  const bool joined = cascaded(0) || cascaded(n);
  const std::int64_t counts = joined ? counter.to_next() : t.to_next_change();
  return counts == kNever ? kNever : m.epoch + (counter.tick + counts) * d;
}

void Tmr::clock_changed(Machine& m, States at) {
  for (unsigned n = 0; n < 2; ++n) {
    if (const States d = divisor(m, n)) timer_[n].tick = (at - m.epoch) / d;
  }
}

void Tmr::clock_edge(Machine& m, unsigned n, bool rising, States at) {
  if (m.stopped(kStopTmr) || !timer_[n].counts_edge(rising)) return;
  advance(m, at);
  step(m, n, 1, at);
}

void Tmr::reset_edge(Machine& m, unsigned n, bool rising, States at) {
  if (m.stopped(kStopTmr) || !rising || timer_[n].clear() != Timer8::Clear::on_pin) return;
  if (n == 1 && cascaded(0)) return;
  advance(m, at);
  timer_[n].count = 0;
  if (n == 0 && cascaded(0)) timer_[1].count = 0;
}

bool Tmr::waits_for_input() const {
  return std::any_of(timer_.begin(), timer_.end(),
                     [](const Timer8& t) { return t.waits_for_clock(); });
}

namespace {

// Counts from a clear to the next, and to the matches in each period of the compared counter.
struct Wave {
  int turn, lap, a, b;
};

// One period after another from the present level, until one begins and ends with the same level: all that
// follow are like it. If none does, the output toggles, and two periods are a whole number of its own.
double mean_level(const Wave& w, bool level, std::uint8_t selection) {
  int high = 0;
  for (int round = 0; round < 4; ++round) {
    const bool begins = level;
    const int before = high;
    int from = 0;
    while (from < w.turn) {
      const int lap = from / w.lap * w.lap;
      int to = std::min(w.turn, lap + w.lap);
      for (const int match : {lap + w.a, lap + w.b}) {
        if (match > from) to = std::min(to, match);
      }
      if (level) high += to - from;
      from = to;
      level = timer_output(level, selection, to == lap + w.a, to == lap + w.b);
    }
    if (level == begins) return static_cast<double>(high - before) / w.turn;
  }
  return static_cast<double>(high) / (4 * w.turn);
}

}  // namespace

double Tmr::high_share(Machine& m, unsigned n) const {
  const Timer8 &t = timer_[n], &lower = timer_[1];
  const auto still = [&] { return t.level ? 1.0 : 0.0; };
  if (divisor(m, cascaded(n) ? 1 - n : n) == 0 || m.stopped(kStopTmr)) return still();
  Wave wave{static_cast<int>(t.turn()), static_cast<int>(t.turn()), t.tcora + 1, t.tcorb + 1};
  if (cascaded(0)) {
    const Timer8& upper = timer_[0];
    const int a = (upper.tcora << 8 | lower.tcora) + 1, b = (upper.tcorb << 8 | lower.tcorb) + 1;
    const int turn = upper.clear() == Timer8::Clear::on_a   ? a
                     : upper.clear() == Timer8::Clear::on_b ? b
                                                            : 0x10000;
    wave = n == 0 ? Wave{turn, turn, a, b} : Wave{turn, 0x100, wave.a, wave.b};
  } else if (cascaded(n) && timer_[0].tcora >= timer_[0].turn()) {
    return still();  // TMR0 has no match A to count
  }
  return mean_level(wave, t.level, t.tcsr_low & TMR_TCSR::OS);
}

std::uint8_t Tmr::peek(std::uint32_t address) const {
  const Timer8& t = timer_[address & 1];
  switch (address & ~1u) {
    case io::TCR0:
      return t.tcr;
    case io::TCSR0:
      return t.flags.value() | t.tcsr_low | (address & 1 ? TMR_TCSR::ONE : 0);
    case io::TCORA0:
      return t.tcora;
    case io::TCORB0:
      return t.tcorb;
    default:
      return t.count;
  }
}

std::uint8_t Tmr::read(Machine& m, std::uint32_t address, States at) {
  advance(m, at);
  if ((address & ~1u) == io::TCSR0) timer_[address & 1].flags.read();
  return peek(address);
}

void Tmr::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  const unsigned n = address & 1, which = address & ~1u;
  Timer8& t = timer_[n];
  const auto advance_this = [&](States to) {
    const bool alone = !cascaded(0) && !cascaded(1) && which != io::TCR0 && !m.stopped(kStopTmr);
    alone ? advance_one(m, n, to) : advance(m, to);
  };
  // Up to the state of the write itself, where a write wins over a count and suppresses a match.
  advance_this(at - 1);
  std::uint8_t* const compare = which == io::TCORA0   ? &t.tcora
                                : which == io::TCORB0 ? &t.tcorb
                                                      : nullptr;
  const std::uint8_t before = compare ? *compare : 0;
  if (compare) *compare = static_cast<std::uint8_t>(~t.count);
  // A word written to a pair of TCORs suppresses both matches: the other timer waits for its byte.
  if (compare || (which == io::TCNT0 && cascaded(n)))
    advance_one(m, cascaded(n) ? 1 - n : n, at);
  else if (which != io::TCNT0)
    advance_this(at);
  const bool drove = drives(n);
  bool changed = false;
  const auto put = [&](std::uint8_t& place, std::uint8_t old, std::uint8_t now) {
    changed = old != now;
    place = now;
  };
  switch (which) {
    case io::TCR0:
      put(t.tcr, t.tcr, value);
      break;
    case io::TCSR0:
      t.flags.write(static_cast<std::uint8_t>(value | ~Timer8::kFlags));
      put(t.tcsr_low, t.tcsr_low,
          static_cast<std::uint8_t>(value & (n == 0 ? ~Timer8::kFlags : TMR_TCSR::OS)));
      break;
    case io::TCORA0:
    case io::TCORB0:
      put(*compare, before, value);
      break;
    default:
      t.count = value;
      break;
  }
  if (changed || which == io::TCNT0) {
    if (const States d = divisor(m, n)) t.tick = (at - m.epoch) / d;
  }
  if (changed && (drove || drives(n))) m.notify(OutputChange::Unit::timer, static_cast<int>(n), at);
  update(m, n, at);
}

}  // namespace kaz::h8s
