// Power-down: software standby, watch mode, and the divided clock of medium speed
// (hardware manual, power-down modes).
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {

// SBYCR.STS: oscillator settling time before clocks resume.
States Machine::settling_states() const {
  constexpr States table[] = {8192, 16384, 32768, 65536, 131072, 262144, 16, 16};
  return table[field<SBYCR::STS>(system.sbycr)];
}

// SBYCR.SCK2-0: states of the modules to one of the CPU.
States Machine::cpu_divider() const {
  const unsigned select = system.sbycr & SBYCR::SCK;
  return select > 5 ? 1 : States{1} << select;
}

void Machine::count_slow() {
  cpu.now = time();
  cpu.stall = 0;
  slow_from_ = kNever;
}

// A request that is pending when SLEEP executes keeps the chip awake.
bool Machine::stands_by() const {
  if (standby_) return true;
  if (!cpu.asleep || !(system.sbycr & SBYCR::SSBY)) return false;
  const auto choice =
      irq.choose(cpu.now, cpu.control, cpu.two_level, options.interrupt_decision_states);
  return choice.vector == 0 && choice.earliest == kNever;
}

void Machine::enter_standby() {
  run_modules(cpu.now);
  standby_ = true;
  wakes_at_ = kNever;
  watch_ = wdt[1].subclocked();
  if (system.lpwrcr & (LPWRCR::DTON | LPWRCR::LSON))
    misuse(io::LPWRCR, "subactive mode and direct transition (LSON, DTON) are not modeled");
  if (watch_ && options.subclock_states == 0)
    misuse(io::WTCSR1, "watch mode needs a subclock, but Options::subclock_states is 0");
  if (field<SBYCR::STS>(system.sbycr) > 5)
    misuse(io::SBYCR, "SBYCR.STS selects a reserved settling time");
  // These modules lose their registers; ports, timers, watchdogs and the DTC keep theirs.
  for (unsigned n = 0; n < 2; ++n) sci[n].reset(*this, n, cpu.now);
  adc.reset(*this, cpu.now);
  pwm.reset();
  pwmx.reset();
  notify(OutputChange::Unit::port, 0, cpu.now);
}

// One step of standby: to the next external event, or to the end of the settling time. Clocks are
// stopped, so the origins of their counts move along.
bool Machine::stand_by(States until) {
  if (!standby_) enter_standby();
  const auto choice = irq.choose(cpu.now, cpu.control, cpu.two_level, 0);
  if (wakes_at_ == kNever && (choice.vector != 0 || choice.earliest != kNever))
    wakes_at_ = cpu.now + settling_states();
  States event = std::min(event_of(Source::pins), wakes_at_);
  if (watch_) event = std::min(event, event_of(Source::wdt1));
  if (event == kNever && !could_wake()) return false;
  const States from = cpu.now;
  sleep_until(std::min(event, until));
  epoch += cpu.now - from;
  events_known_ = false;
  if (cpu.now >= wakes_at_) standby_ = false;
  return true;
}

}  // namespace kaz::h8s
