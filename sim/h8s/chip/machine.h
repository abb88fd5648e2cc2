// All modules of the chip, and the loop that runs the modules. Internal; chip.h is the public interface.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/h8s/chip/adc.h"
#include "sim/h8s/chip/boot.h"
#include "sim/h8s/chip/chip.h"
#include "sim/h8s/chip/dtc.h"
#include "sim/h8s/chip/flash.h"
#include "sim/h8s/chip/frt.h"
#include "sim/h8s/chip/interrupts.h"
#include "sim/h8s/chip/observer.h"
#include "sim/h8s/chip/pin_watch.h"
#include "sim/h8s/chip/ports.h"
#include "sim/h8s/chip/pwm.h"
#include "sim/h8s/chip/pwmx.h"
#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/chip/sci.h"
#include "sim/h8s/chip/tmr.h"
#include "sim/h8s/chip/tmr_xy.h"
#include "sim/h8s/chip/wdt.h"
#include "sim/h8s/cpu/cpu.h"
#include "sim/h8s/translate/translator.h"

namespace kaz::h8s {

// Returns the number of a module stop bit in MSTPCR. `high` is the bit's mask in MSTPCRH, and `low` is the
// bit's mask in MSTPCRL. One of the two masks is 0.
constexpr unsigned mstp(unsigned high, unsigned low = 0) {
  return static_cast<unsigned>(std::countr_zero(high << 8 | low));
}
inline constexpr unsigned kStopDtc = mstp(MSTPCRH::DTC), kStopFrt = mstp(MSTPCRH::FRT),
                          kStopTmr = mstp(MSTPCRH::TMR01), kStopPwm = mstp(MSTPCRH::PWM),
                          kStopAdc = mstp(MSTPCRH::ADC), kStopTmrxy = mstp(MSTPCRH::TMRXY),
                          kStopSci0 = mstp(0, MSTPCRL::SCI0), kStopSci1 = mstp(0, MSTPCRL::SCI1);

// Callbacks of the chip's user. An empty function means no callback.
struct Listeners {
  std::function<void(const OutputChange&)> output;
  std::function<void(int, const TransmittedByte&)> transmitted;
  std::function<void(States)> watchdog;
  std::function<double(int, States)> analog;
};

// System registers that do not belong to a module class.
struct SystemRegisters {
  std::uint8_t stcr = 0, syscr = SYSCR::XRST | SYSCR::RAME, mdcr = 0, bcr = 0xd7, wscr = 0x33;
  std::uint8_t syscr2 = 0, sbycr = 0, lpwrcr = 0;
  std::uint16_t mstpcr = 0x3fff;
  template <class A>
  void transfer(A& a) {
    a(stcr, syscr, mdcr, bcr, wscr, syscr2, sbycr, lpwrcr, mstpcr);
  }
};

// Modules with events. Events at the same time are processed in the order of this list.
enum class Source : unsigned { sci0, wdt0, sci1, wdt1, adc, frt, tmr, tmr_xy, pins, boot };
inline constexpr unsigned kSources = 10;

struct Place;

struct CodeFree {
  void operator()(Insn* p) const;
};

class Machine final : public Bus {
 public:
  explicit Machine(const Options& options);
  // Copies the state without listeners and hooks.
  Machine(const Machine& other);
  Machine& operator=(const Machine&) = delete;

  // Copies the state of another machine. This machine keeps its own listeners and hooks.
  void take_state(const Machine& other);
  // Write and read the state as bytes (state.cpp).
  void write_state(StateWriter& to);
  void read_state(StateReader& from);

  void power_on(std::uint8_t ram_fill);
  void reset(ResetCause cause, States at);
  // Clears an error stop.
  void revive() {
    dead.reset();
    cpu.fault = Fault::none;
  }
  Stop run(Chip& chip, States until, bool single);

  // --- observers -------------------------------------------------------------------------------
  void attach(Observer& observer);
  void detach(Observer& observer);
  void request_stop();
  void memory_changed(std::uint32_t address, std::uint32_t size);

  // --- for the CPU (bus.h) -----------------------------------------------------------------------
  std::uint8_t load8(std::uint32_t address) override;
  std::uint16_t load16(std::uint32_t address) override;
  void store8(std::uint32_t address, std::uint8_t value) override;
  void store16(std::uint32_t address, std::uint16_t value) override;
  std::uint8_t load_io8(std::uint32_t address) override;
  std::uint16_t load_io16(std::uint32_t address) override;
  void store_io8(std::uint32_t address, std::uint8_t value) override;
  void store_io16(std::uint32_t address, std::uint16_t value) override;
  void odd_word_access(std::uint32_t address) override;
  bool interrupt_pending() const override { return irq.any_unmasked(cpu.control, cpu.two_level); }
  bool hook_due(std::uint32_t pc) const override { return pc != unhooked_ && hooks.contains(pc); }
  bool has_hook(std::uint32_t pc) const override { return hooks.contains(pc); }
  void run_observed() override;

  // --- for the modules ---------------------------------------------------------------------------

  // Returns the current time. During a bus access, the current time is the end of the access.
  States time() const {
    const States at = cpu.now + cpu.stall;
    return slow_from_ == kNever ? at : slow_from_ + (at - slow_from_) * slow_by_;
  }
  // Returns the time of the event being processed, otherwise time().
  States event_time() const { return processing_ != kNever ? processing_ : time(); }
  // Advances the timers that can drive pins.
  void advance_outputs(States at) {
    frt.advance(*this, at);
    tmr.advance(*this, at);
    tmr_xy.advance(*this, at);
  }
  // Sets the level that the board drives at a pin (nullopt: the board stops driving the pin) and applies the
  // effects of the change.
  void set_input(unsigned port, unsigned bit, std::optional<bool> level);
  void set_nmi(bool level);
  bool stopped(unsigned bit) const { return (system.mstpcr >> bit & 1) != 0; }
  std::uint8_t stcr() const { return system.stcr; }
  void notify(OutputChange::Unit unit, int index, States at) {
    if (!listeners.output) return;
    if (unit != OutputChange::Unit::serial) convert_before(at);
    listeners.output({unit, index, at});
  }
  // Returns whether conversions that request no interrupt may be computed late or skipped.
  bool conversions_wait() const { return steady_analog && !input_log && observers.empty(); }
  // These functions compute the delayed conversions. convert_before() computes the conversions before the
  // time `at`. convert_all() computes the conversions up to now. Both functions must be called before the
  // inputs of the delayed conversions change.
  void convert_before(States at) {
    if (conversions_wait()) adc.advance(*this, at - 1);
  }
  void convert_all() {
    if (conversions_wait()) adc.advance(*this, event_time());
  }
  void misuse(std::uint32_t address, const char* text);
  // Must be called after an action that may have changed the next event of a module. Makes the CPU stop in
  // time for the event.
  void rescheduled(Source source);
  // Reschedules all modules. Must be called after external writes and other changes with unknown effects.
  void reschedule_all();
  void pin_edge(unsigned port, unsigned bit, bool rising, States at);

  // --- memory ------------------------------------------------------------------------------------

  // Returns a pointer to the byte of flash or RAM at `address`, or null if `address` is outside flash and
  // RAM.
  std::uint8_t* memory_at(std::uint32_t address);
  const std::uint8_t* memory_at(std::uint32_t address) const;
  std::uint8_t io_read(std::uint32_t address);
  void io_write(std::uint32_t address, std::uint8_t value);
  void io_write_word(std::uint32_t address, std::uint16_t value);
  // Reads without side effects, except that timers are advanced. Returns nullopt for an address without a
  // register.
  std::optional<std::uint8_t> io_peek(std::uint32_t address);
  bool is_io(std::uint32_t address) const { return h8s::is_io(cpu, address); }
  // Returns whether the register is on the 16-bit internal bus.
  bool wide(std::uint32_t address) const;
  void forget_flash(std::uint32_t address, std::uint32_t size);
  void set_ram_enabled(bool on);
  void forget_all_code();
  // Selects the addresses that the CPU accesses on its fast path.
  void choose_paths();
  void set_hook(std::uint32_t pc, Chip::CodeHook hook);
  void clear_hook(std::uint32_t pc);
  void hook_changed(std::uint32_t address);
  void set_pc(std::uint32_t pc);
  std::uint32_t pc() const { return pc_of(cpu, cpu.ip); }

  void forget_code_at(std::uint32_t address);

  bool pw_driven(int channel) const;
  bool serial_drives(int channel) const;
  int pw_high_counts(int channel) const;
  bool tmo_driven(int timer) const;
  double tmo_high_share(int timer);

  // Returns null if Options::engine is not the translator, or if this build does not contain the translator.
  const Translator* translator() const { return cpu.translated ? translator_.get() : nullptr; }

  std::string report(const std::string& headline) const;
  std::string disassemble(std::uint32_t address, int* length) const;

  Options options;
  Cpu cpu;
  Interrupts irq;
  Ports ports;
  Frt frt;
  Tmr tmr;
  TmrXY tmr_xy;
  Pwm pwm;
  Pwmx pwmx;
  std::array<Sci, 2> sci;
  Adc adc;
  std::array<Wdt, 2> wdt;
  FlashControl flash_control;
  BootRom boot;
  PinWatch pins;
  Dtc dtc;
  SystemRegisters system;

  // `epoch` is the time at which the prescalers were 0: the time of the last reset plus the time during which
  // the clock was stopped. `sub_epoch` is the time of the last reset of the subclock's prescalers. The
  // subclock never stops.
  States epoch = 0, sub_epoch = 0;
  ResetCause cause = ResetCause::power_on;
  bool watchdog_reset = false;  // a watchdog has requested a reset
  std::vector<Misuse> misuses;
  std::optional<Stop> dead;  // error stop, kept until reset

  Listeners listeners;
  std::vector<Observer*> observers;
  InputLog* input_log = nullptr;  // Chip::set_input_log
  bool running = false;           // inside run()
  bool in_hook = false;           // inside a code hook; hooks run at instruction boundaries
  std::function<double(int, States)> analog_source;
  bool steady_analog = false;  // Chip::set_analog
  // Must be called before an input is applied. `apply` repeats the input on another chip.
  void log_input(std::function<void(Chip&)> apply);
  void log_cut();
  void connect_analog();
  std::map<std::uint32_t, Chip::CodeHook> hooks;
  std::shared_ptr<const SymbolTable> symbols = std::make_shared<SymbolTable>();

 private:
  void notify_access(std::uint32_t address, unsigned size, unsigned value, bool write);
  template <class A>
  void transfer(A& a);
  template <class A>
  void transfer_cpu(A& a);
  void attach();
  // Returns whether the code that this machine has decoded is valid for the state of `other`.
  bool runs_code_of(const Machine& other) const;
  void sleep_until(States at);
  std::uint8_t io_read_at(std::uint32_t address, States at);
  void io_write_at(std::uint32_t address, std::uint8_t value, States at);
  std::uint8_t read_register(const Place& place, std::uint32_t address, States at);
  void write_register(const Place& place, std::uint32_t a, std::uint8_t value, States at);
  void accessed(const Place& place, std::uint32_t a, States at, bool written);
  void check_raised();
  void sample_pins(unsigned of_ports);
  bool module_stopped(const Place& place) const;
  void find_frequent();
  bool due(Source source, States at) const { return events_[static_cast<unsigned>(source)] <= at; }
  void write_system(std::uint32_t address, std::uint8_t value, States at);
  void set_module_stop(std::uint16_t value, States at);
  // Advances every module to `to`, even without an event.
  void run_modules(States to);
  void advance(Source source, States to);
  States event_of(Source source);
  States adc_event() const {
    return conversions_wait() && adc.may_wait() ? adc.next_request() : adc.next_event();
  }
  void know_events() {
    if (!events_known_)
      find_events();
    else if (stale_)
      first_events();
  }
  States next_event() {
    know_events();
    return next_event_;
  }
  States next_stop() {
    know_events();
    return next_stop_;
  }
  // Returns the time at which the CPU must stop for an event of a module. If the event only raises a request,
  // the result is the first time at which the CPU or the DTC could accept that request. Other changes of the
  // module are computed at the next access to the module.
  States stop_for(Source source, States event) const {
    if (source != Source::adc && source != Source::sci0 && source != Source::sci1) return event;
    const States request = source == Source::adc ? adc.next_request() : event;
    if (request == kNever) return kNever;
    return request + std::min(options.interrupt_decision_states, options.dtc_decision_states) + 1;
  }
  void find_events();
  void first_events();
  void set_event(unsigned k, States event, States stop) {
    events_[k] = event;
    stops_[k] = stop;
    with_event_ = event == kNever ? with_event_ & ~(1u << k) : with_event_ | 1u << k;
  }
  void rescheduled(Source source, States event);
  void run_events(States to);
  // Processes all events up to `to`. Must be called before a register access.
  void settle(States to) {
    if (!events_known_ || next_event_ <= to) process_events(to);
  }
  void run_conversions(States to);
  void process_events(States to);
  void accept(unsigned vector);
  bool could_wake() const;
  void stretch(States stop, bool one);
  // --- power.cpp
  States settling_states() const;
  States cpu_divider() const;
  void begin_slow() {
    slow_by_ = (system.sbycr & SBYCR::SCK) == 0 ? 1 : cpu_divider();
    slow_from_ = slow_by_ == 1 ? kNever : cpu.now;
  }
  void end_slow() {
    if (slow_from_ != kNever) count_slow();
  }
  void count_slow();
  bool stands_by() const;
  void enter_standby();
  bool stand_by(States until);  // returns false if nothing can end the standby
  Stop error_stop(Stop::Reason reason, const std::string& headline);
  Stop stop_for_fault();
  enum class Hooked { none, ran, stop };
  Hooked run_hook(Chip& chip, States stop, bool one);
  Stop run_to(Chip& chip, States until, bool single);

  // For each register in FE00..FFFF: the module whose fast path serves frequent accesses to the register.
  // `none`: the register has no fast path, or the module is stopped. The table is recomputed when STCR or
  // MSTPCR changes.
  enum class Frequent : std::uint8_t { none, adc, pwm, ports, sci0, sci1 };
  std::array<Frequent, 0x200> frequent_{};

  std::vector<std::uint8_t> flash_;
  std::array<std::uint8_t, 0x2000> block_{};
  std::unique_ptr<Insn, CodeFree> code_;
  std::unique_ptr<Translator> translator_;
  static constexpr std::uint32_t kNoAddress = 0xffffffff;
  // Address whose hook has been called but whose instruction has not run.
  std::uint32_t hook_done_ = kNoAddress;
  // Address of an instruction that runs without a call of its code hook.
  std::uint32_t unhooked_ = kNoAddress;
  bool first_after_reset_ = false;
  bool standby_ = false, watch_ = false;  // software standby; watch mode
  States wakes_at_ = kNever;              // end of the oscillator's settling time
  States slow_from_ = kNever;             // start of execution on a divided clock
  States slow_by_ = 1;                    // clock divider since slow_from_
  bool stop_requested_ = false;
  // Time of each module's next event, and the time at which the CPU must stop for this event. These times are
  // recomputed only after an action that may change a module's next event.
  std::array<States, kSources> events_{}, stops_{};
  unsigned with_event_ = 0;                // mask of the modules with an event
  States next_event_ = 0, next_stop_ = 0;  // minimum of events_; minimum of stops_
  States other_event_ = 0;                 // earliest event of a module other than the converter
  unsigned other_first_ = 0;               // module of other_event_
  bool events_known_ = false;
  bool stale_ = false;          // next_event_ and next_stop_ are lower bounds
  bool rescheduled_ = false;    // a module was rescheduled since run_conversions() began
  States processing_ = kNever;  // time of the event being processed
};

}  // namespace kaz::h8s
