// The outer loop: events, interrupts, sleep, hooks and stops around the CPU's inner loop.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>

#include "sim/h8s/chip/machine.h"
#include "sim/h8s/chip/observer.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {
namespace {

constexpr auto kOfAdc = static_cast<unsigned>(Source::adc);

std::string hex6(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%06x", value & 0xffffff);
  return text;
}

// Sets Machine::running for the duration of a run. A hook may run a clone, never this chip.
class Running {
 public:
  explicit Running(bool& flag) : flag_(flag) { flag_ = true; }
  ~Running() { flag_ = false; }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

 private:
  bool& flag_;
};

}  // namespace

States Machine::event_of(Source source) {
  switch (source) {
    case Source::sci0:
      return sci[0].next_event();
    case Source::wdt0:
      return wdt[0].next_event(*this, 0);
    case Source::sci1:
      return sci[1].next_event();
    case Source::wdt1:
      return wdt[1].next_event(*this, 1);
    case Source::adc:
      return adc_event();
    case Source::frt:
      return stopped(kStopFrt) ? kNever : frt.next_event(epoch);
    case Source::tmr:
      return stopped(kStopTmr) ? kNever : tmr.next_event(*this);
    case Source::tmr_xy:
      return stopped(kStopTmrxy) ? kNever : tmr_xy.next_event(*this);
    case Source::pins:
      return pins.active() ? pins.next_event(*this) : kNever;
    case Source::boot:
      return boot.next_event();
  }
  return kNever;
}

void Machine::advance(Source source, States to) {
  switch (source) {
    case Source::sci0:
      return sci[0].advance(*this, 0, to);
    case Source::wdt0:
      return wdt[0].advance(*this, 0, to);
    case Source::sci1:
      return sci[1].advance(*this, 1, to);
    case Source::wdt1:
      return wdt[1].advance(*this, 1, to);
    case Source::adc:
      return adc.advance(*this, to);
    case Source::frt:
      return frt.advance(*this, to);
    case Source::tmr:
      return tmr.advance(*this, to);
    case Source::tmr_xy:
      return tmr_xy.advance(*this, to);
    case Source::pins:
      return pins.advance(*this, to);
    case Source::boot:
      return boot.advance(*this, to);
  }
}

void Machine::find_events() {
  for (unsigned k = 0; k < kSources; ++k) {
    const auto source = static_cast<Source>(k);
    const States event = event_of(source);
    set_event(k, event, stop_for(source, event));
  }
  first_events();
  events_known_ = true;
}

void Machine::first_events() {
  States event = kNever, stop = stops_[kOfAdc];
  unsigned first = kSources;
  for (unsigned left = with_event_ & ~(1u << kOfAdc); left != 0; left &= left - 1) {
    const auto k = static_cast<unsigned>(std::countr_zero(left));
    if (events_[k] < event) {
      event = events_[k];
      first = k;
    }
    stop = std::min(stop, stops_[k]);
  }
  stale_ = false;
  other_event_ = event;
  other_first_ = first;
  next_stop_ = stop;
  next_event_ = std::min(event, events_[kOfAdc]);
}

void Machine::rescheduled(Source source) {
  rescheduled_ = true;
  if (events_known_) rescheduled(source, event_of(source));
}

// Where the earliest of all may have become later, what is known of it remains a bound until it is needed.
void Machine::rescheduled(Source source, States event) {
  rescheduled_ = true;
  if (!events_known_) return;
  const auto k = static_cast<unsigned>(source);
  const States stop = stop_for(source, event);
  if (event == events_[k] && stop == stops_[k]) return;
  stale_ = true;
  set_event(k, event, stop);
  next_event_ = std::min(next_event_, event);
  next_stop_ = std::min(next_stop_, stop);
  cpu.stop = std::min(cpu.stop, stop - cpu.stall);
}

void Machine::reschedule_all() {
  rescheduled_ = true;
  events_known_ = false;
  end_stretch(cpu);
}

void Machine::run_modules(States to) {
  events_known_ = false;
  for (unsigned k = 0; k < kSources; ++k) {
    if (const auto source = static_cast<Source>(k); source != Source::pins) advance(source, to);
  }
}

// Processes events in order of time, so that one may cause the next. A module without an event is not
// advanced until it is accessed.
void Machine::run_events(States to) {
  if (events_known_ && next_event_ > to) return;
  for (;;) {
    know_events();
    if (other_event_ > to || events_[kOfAdc] < other_event_) {
      if (events_[kOfAdc] > to) break;
      run_conversions(std::min(to, other_event_ - 1));
      continue;
    }
    const unsigned first =
        events_[kOfAdc] == other_event_ ? std::min(other_first_, kOfAdc) : other_first_;
    const auto source = static_cast<Source>(first);
    processing_ = events_[first];
    advance(source, processing_);
    const States event = event_of(source);
    set_event(first, event, stop_for(source, event));
    // A frame that begins now may have been sampled at this state before it began.
    if ((source == Source::sci0 || source == Source::sci1) && pins.active()) {
      constexpr auto of_pins = static_cast<unsigned>(Source::pins);
      pins.sample(*this, processing_);
      const States edge = event_of(Source::pins);
      set_event(of_pins, edge, stop_for(Source::pins, edge));
    }
    stale_ = true;
  }
  processing_ = kNever;
  cpu.stop = std::min(cpu.stop, next_stop_ - cpu.stall);
}

// The converter's events until another module has one: those of a scan are frequent, and affect nothing
// but the converter, unless what is called for a sample reschedules a module.
void Machine::run_conversions(States to) {
  rescheduled_ = false;
  adc.run_events(*this, to, processing_, rescheduled_);
  if (!events_known_) return;
  const States event = event_of(Source::adc);
  set_event(kOfAdc, event, stop_for(Source::adc, event));
  stale_ = true;
}

void Machine::set_input(unsigned port, unsigned bit, std::optional<bool> level) {
  const States at = event_time();
  ports.set_input(*this, port, bit, level, at);
  if (pins.active()) pins.sample(*this, at);
  reschedule_all();
}

void Machine::set_nmi(bool level) {
  const States at = event_time();
  irq.set_nmi_pin(level, (system.syscr & SYSCR::NMIEG) != 0, at);
  if (pins.active()) pins.sample(*this, at);
  reschedule_all();
}

void Machine::accept(unsigned vector) {
  irq.accepted(vector, cpu.now);
  // An interrupted EEPMOV.W: the program finds R4 not 0 and restarts it.
  const std::uint32_t back = pc() + (cpu.moving ? 4 : 0);
  cpu.moving = false;
  cpu.asleep = false;
  const States from = cpu.now;
  // Stacking 2, vector 2 (1 in normal mode), first fetch 2, internal.
  cpu.now += 4 + (cpu.normal ? 1 : 2) + options.exception_internal_states;
  cpu.ip = enter_exception(cpu, cpu.ip, back, vector);
  hook_done_ = kNoAddress;
  if (observers.empty()) return;
  const ExceptionEntry entry{vector, back, pc(), from, time()};
  for (Observer* o : observers) o->entered(entry);
}

// Whether an external event may still end the sleep: an enabled pin or a received byte.
bool Machine::could_wake() const {
  if ((cpu.control & CCR::I) && !(cpu.two_level && !(cpu.control & CCR::UI))) return false;
  return irq.any_irq_enabled() || sci[0].waits_for_input() || sci[1].waits_for_input() ||
         frt.waits_for_input() || tmr.waits_for_input() || tmr_xy.waits_for_input();
}

Stop Machine::error_stop(Stop::Reason reason, const std::string& headline) {
  dead = Stop{reason, report(headline)};
  return *dead;
}

Stop Machine::stop_for_fault() {
  const std::string at = " at " + symbols->describe(cpu.fault_pc);
  const std::string where = hex6(cpu.fault_address);
  // Report the instruction that failed, not the one after it.
  if (cpu.fault != Fault::fetch) cpu.ip = at_address(cpu, cpu.fault_pc);
  switch (cpu.fault) {
    case Fault::undefined:
      return error_stop(Stop::Reason::undefined_instruction,
                        "undefined instruction " + disassemble(cpu.fault_pc, nullptr) + at);
    case Fault::fetch:
      return error_stop(Stop::Reason::undefined_instruction,
                        "instruction fetch outside flash and RAM, at " + where);
    case Fault::stack:
      return error_stop(Stop::Reason::stack_outside_ram,
                        "stack access outside RAM, to " + where + at);
    case Fault::misuse:
      return error_stop(
          Stop::Reason::undefined_register_use,
          (misuses.empty() ? std::string("misuse") : misuses.back().text) + ", " + where + at);
    default:
      return error_stop(Stop::Reason::unmapped_access,
                        "access outside flash, RAM and registers, to " + where + at);
  }
}

void Machine::stretch(States stop, bool one) {
  begin_slow();
  cpu.stop = one || stop <= cpu.now || slow_from_ != kNever ? cpu.now + 1 : stop;
  cpu.hold_off = false;
  first_after_reset_ = false;
  run_stretch(cpu);
  end_slow();
  cpu.now += cpu.stall;
  cpu.stall = 0;
}

// Calls the hook of the next instruction, if there is one, and runs that instruction.
Machine::Hooked Machine::run_hook(Chip& chip, States stop, bool one) {
  const std::uint32_t at = pc();
  const auto found = hooks.find(at);
  if (found == hooks.end()) return Hooked::none;
  // A resumed EEPMOV.W has already called its hook.
  if (hook_done_ != at && !cpu.moving) {
    hook_done_ = at;
    const Chip::CodeHook hook = found->second;  // it may remove itself
    convert_all();
    in_hook = true;
    const HookAction action = hook(chip);
    in_hook = false;
    events_known_ = false;
    if (pc() != at) hook_done_ = kNoAddress;
    if (action == HookAction::stop) return Hooked::stop;
    return Hooked::ran;  // look at everything again: the hook may have changed registers
  }
  Insn* slot = const_cast<Insn*>(cpu.ip);
  if (slot != &cpu.outside) slot->run = nullptr;
  unhooked_ = at;
  // One instruction; an EEPMOV.W until the next event.
  stretch(one || !cpu.moving ? cpu.now : stop, one || !cpu.moving);
  unhooked_ = kNoAddress;
  hook_done_ = kNoAddress;
  if (slot != &cpu.outside) slot->run = nullptr;
  return Hooked::ran;
}

Stop Machine::run(Chip& chip, States until, bool single) {
  Stop stop = run_to(chip, until, single);
  convert_all();  // what is sampled may change before the next run
  return stop;
}

Stop Machine::run_to(Chip& chip, States until, bool single) {
  const std::int64_t executed = cpu.executed;
  const States began = cpu.now;
  events_known_ = false;
  stop_requested_ = false;
  const Running guard(running);
  for (;;) {
    if (dead) return *dead;
    if (cpu.fault != Fault::none) return stop_for_fault();
    run_events(cpu.now);
    if (watchdog_reset) {
      reset(ResetCause::watchdog, cpu.now + options.watchdog_reset_states);
      events_known_ = false;
      if (listeners.watchdog) listeners.watchdog(cpu.now);
    }
    if (stop_requested_) {
      stop_requested_ = false;
      return {Stop::Reason::requested, report("stopped by an observer")};
    }
    if (single ? cpu.executed != executed || cpu.now != began : cpu.now >= until) return {};
    if (boot.active()) {
      const States next = std::min(next_event(), until);
      if (next == kNever) return {};
      sleep_until(next);
      continue;
    }
    if ((standby_ || (cpu.asleep && (system.sbycr & SBYCR::SSBY))) && stands_by()) {
      if (!stand_by(until))
        return error_stop(Stop::Reason::asleep_forever,
                          "standby without an enabled wake-up source; the next instruction is at " +
                              symbols->describe(pc()));
      continue;
    }
    // The DTC takes the bus between two instructions, regardless of the CPU's interrupt mask.
    const bool moves = irq.any_diverted() || !dtc.idle();
    if (moves) {
      begin_slow();
      const bool moved = dtc.run(*this);
      end_slow();
      if (moved) continue;
    }
    bool guarded = cpu.hold_off || first_after_reset_;
    States event = next_stop();
    if (moves) event = std::min(event, dtc.earliest(*this));
    if (irq.any_unmasked(cpu.control, cpu.two_level)) {
      const auto choice =
          irq.choose(cpu.now, cpu.control, cpu.two_level, options.interrupt_decision_states);
      if (choice.vector != 0 && !guarded) {
        begin_slow();
        accept(choice.vector);
        end_slow();
        // Nearly always there is nothing to look at before the handler runs.
        if (!single && !moves && (hooks.empty() || !hooks.contains(pc())) &&
            cpu.fault == Fault::none && !stop_requested_ && events_known_ && !stale_ &&
            next_event_ > cpu.now && cpu.now < until && !irq.watches_fetches() &&
            !irq.any_diverted() && !irq.any_unmasked(cpu.control, cpu.two_level))
          stretch(std::min(next_stop_, until), false);
        continue;
      }
      event = std::min(event, choice.earliest);
    }
    if (cpu.asleep) {
      // A conversion without an interrupt ends no sleep, but is no error either.
      const States any_event = std::min(next_event(), adc.next_event());
      if (event == kNever && single && until == kNever) event = any_event;
      if (event == kNever && any_event == kNever && !could_wake())
        return error_stop(Stop::Reason::asleep_forever,
                          "SLEEP without an enabled wake-up source; the next instruction is at " +
                              symbols->describe(pc()));
      if (single && event == kNever && until == kNever) return {};
      sleep_until(std::min(event, until));
      cpu.hold_off = first_after_reset_ = false;
      continue;
    }
    // Address breaks are checked before each instruction.
    const bool watched = irq.watches_fetches();
    if (watched) irq.fetched(pc(), cpu.now);
    guarded |= watched;
    if (!hooks.empty()) {
      const Hooked hooked = run_hook(chip, std::min(event, until), single || guarded);
      if (hooked == Hooked::stop)
        return {Stop::Reason::breakpoint, report("breakpoint at " + symbols->describe(pc()))};
      if (hooked == Hooked::ran) continue;
    }
    stretch(std::min(event, until), single || guarded);
  }
}

}  // namespace kaz::h8s
