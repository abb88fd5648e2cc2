// The chip: an H8S/2128 with everything on it, executed instruction by instruction.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/base/archive.hpp"
#include "shared/base/result.hpp"
#include "shared/image/image.h"
#include "sim/h8s/chip/options.h"
#include "sim/h8s/chip/pins.h"

namespace kaz::h8s {

// I/O ports by their numbers; port 7 is input only (hardware manual, "I/O Ports").
enum class Port { p1 = 1, p2, p3, p4, p5, p6, p7 };

// Why run_until or step returned.
struct Stop {
  enum class Reason {
    reached,                 // now() >= until
    breakpoint,              // a code hook requested it; the instruction there has not run
    undefined_instruction,   // also: instruction fetch outside flash and RAM
    unmapped_access,         // data access outside flash, RAM and I/O
    stack_outside_ram,       // push, pop, call, return or exception with ER7 outside RAM
    undefined_register_use,  // only with Options::stop_on_misuse
    asleep_forever,          // SLEEP with nothing enabled that could wake it
    requested,  // Chip::request_stop, after the instruction or exception entry observed
  };
  friend constexpr Reason last_value(Reason) { return Reason::requested; }
  Reason reason = Reason::reached;
  // Empty for `reached`; else several lines: error, symbol, registers, back-trace, last instructions.
  std::string report;
  template <class A>
  void transfer(A& a) {
    a(reason, report);
  }
};

// Levels of a port's pins; bit n is pin n. Bits that are not `driven` are inputs, whose level the
// board defines.
struct PortOutput {
  std::uint8_t level = 0;
  std::uint8_t driven = 0;
  bool operator==(const PortOutput&) const = default;
};

// An output register was written: the pins of this unit may change from `at` on.
struct OutputChange {
  enum class Unit { port, pwm, timer, serial };
  Unit unit = Unit::port;
  // port: 1..6, 0 for all (reset); pwm: channel 0..15, -1 for all; timer: 0, 1 (TMO0, TMO1);
  // serial: 0, 1 (a frame begins on TxD, or clocks on SCK)
  int index = 0;
  States at = 0;
};

// A byte to be received at RxD.
struct ReceivedByte {
  std::uint8_t value = 0;
  States at = 0;  // end of its last stop bit
  bool framing_error = false;
  bool parity_error = false;
  bool multiprocessor = false;  // its multiprocessor bit, where SMR.MP enables one
  // The sender's bit time, in states. If it differs from the channel's, the channel samples the
  // sender's waveform at its own bit times (line_rate.h). 0: same as the channel's.
  States bit_states = 0;
  template <class A>
  void transfer(A& a) {
    a(value, at, framing_error, parity_error, multiprocessor, bit_states);
    a.require(bit_states >= 0, "bit time");
  }
};

// A byte that has been transmitted at TxD.
struct TransmittedByte {
  std::uint8_t value = 0;
  States start = 0;  // beginning of the start bit
  States end = 0;    // end of the last stop bit
};

enum class ResetCause { power_on, pin, watchdog };
constexpr ResetCause last_value(ResetCause) {
  return ResetCause::watchdog;
}

// Use of a register that the manual forbids or leaves undefined. Execution continues.
struct Misuse {
  std::uint32_t address = 0;  // of the register or memory
  std::uint32_t pc = 0;       // of the instruction
  std::string text;           // one sentence
  std::int64_t count = 0;
  States first = 0;  // time of the first occurrence
  template <class A>
  void transfer(A& a) {
    a(address, pc, text, count, first);
  }
};

struct CallResult {
  std::uint32_t er0 = 0;
  States states = 0;  // from the first instruction to the end of RTS
};

// Erase and program operations since the chip was created (hardware manual, "ROM").
struct FlashStatistics {
  struct Block {
    std::int64_t erasures = 0;  // pulses that changed cells: wear
    std::int64_t erase_pulses = 0, program_pulses = 0;
    std::int64_t weak_pulses = 0;   // shorter than the manual's
    std::int64_t reprogrammed = 0;  // pulses that programmed a bit which was already 0
    template <class A>
    void transfer(A& a) {
      a(erasures, erase_pulses, program_pulses, weak_pulses, reprogrammed);
    }
  };
  std::array<Block, 10> blocks{};  // EB0..EB9
  std::int64_t errors = 0;         // times that FLER was set
  template <class A>
  void transfer(A& a) {
    a(blocks, errors);
  }
};

// What run_until does after a code hook.
enum class HookAction { go_on, stop };

class Machine;
class Observer;
class InputLog;

// Addresses have 24 bits, 16 in normal mode; higher bits are ignored. Times are states since power-on. A
// chip is used by one thread at a time; different chips are independent.
class Chip {
 public:
  explicit Chip(const Options& options = {});
  ~Chip();
  Chip(Chip&&) noexcept;
  Chip& operator=(Chip&&) noexcept;

  // A second chip in the same state, without callbacks, hooks and analog source.
  Chip clone() const;
  // Snapshot of the whole state, to restore into this or another chip. Callbacks are not part of it.
  std::shared_ptr<const Chip> save() const;
  void restore(const Chip& saved);
  // The same as bytes, for files. Readable only by the same build, into a chip with the same options.
  // After a reader error the chip has been powered on, with undefined flash.
  void write_state(StateWriter& to) const;
  void read_state(StateReader& from);

  // Program
  // -------

  // Writes the image's segments to flash at their load addresses and fills the rest of the flash with
  // 0xff. Does not reset. Errors: a segment outside the flash.
  Result<void> load(const Image& image);
  // For programs that start at their entry point instead of by reset: writes every section at its run
  // address in flash or RAM, leaves other memory unchanged and sets PC to `entry`. Call after
  // power_on. Errors: a section outside flash and RAM.
  Result<void> place(const Image& image, std::uint32_t entry);
  // Symbols for reports; memory is unchanged (for an S-record image with a COFF file beside it).
  void set_symbols(SymbolTable symbols);
  const SymbolTable& symbols() const;

  // Execution
  // ---------

  // Fills RAM with `ram_fill` (real RAM holds random data), sets time to 0 and resets.
  void power_on(std::uint8_t ram_fill = 0xa5);
  // RES pin low and high again, in zero time. RAM is kept; an error stop is cleared.
  void reset();
  // Levels of MD1 and MD0 (Options::mode), sampled at the next reset.
  void set_mode_pins(int mode);
  // True while the boot ROM runs, false once it has started the downloaded program.
  bool in_boot_rom() const;
  // Runs whole instructions until now() >= until or a stop. After an error stop each further call
  // returns the same stop until reset.
  Stop run_until(States until);
  // Runs one instruction or exception entry; while asleep, advances to the next event, at most to
  // `no_later`.
  Stop step(States no_later = std::numeric_limits<States>::max());
  States now() const;
  // Instructions executed since power-on.
  std::int64_t instructions() const;
  // How many of them ran as translated host code. For measurements; not part of save().
  std::int64_t translated_instructions() const;
  // The engine in use: `Options::engine`, or the interpreter where the translator is not available.
  Engine engine() const;
  bool asleep() const;
  ResetCause reset_cause() const;
  // Called at each watchdog reset, before the first instruction.
  void on_watchdog_reset(std::function<void(States)> listener);

  // Inspection and debugging
  // ------------------------

  Registers registers() const;  // in a listener: see watch()
  void set_registers(const Registers& registers);
  // Reads flash, RAM and I/O registers without side effects; takes no time. Unmapped addresses: nullopt,
  // or false.
  std::optional<std::uint8_t> peek(std::uint32_t address) const;
  std::optional<std::uint16_t> peek16(std::uint32_t address) const;
  std::optional<std::uint32_t> peek32(std::uint32_t address) const;
  bool peek(std::uint32_t address, std::span<std::uint8_t> to) const;
  // Writes flash or RAM, not I/O registers; takes no time. False: an address outside both; bytes before
  // it are written.
  bool poke(std::uint32_t address, std::uint8_t value);
  bool poke(std::uint32_t address, std::span<const std::uint8_t> from);

  // Calls `hook` each time before the instruction at `address` runs. At most one hook per address.
  using CodeHook = std::function<HookAction(Chip&)>;
  void set_hook(std::uint32_t address, CodeHook hook);
  void set_breakpoint(std::uint32_t address);
  void clear_hook(std::uint32_t address);

  // Notifies `observer` (observer.h) until detach, which must precede the destruction of either. An
  // observed chip runs slower, with the same results. Observers are not part of save() or clone().
  void attach(Observer& observer);
  void detach(Observer& observer);
  // For observers: ends run_until or step at the next instruction boundary with Reason::requested.
  void request_stop();
  // Reports all external input to `log`, for replay by debug/history.h; null disables it.
  void set_input_log(InputLog* log);

  // Calls a C function of the image on this chip (use a clone), with interrupts masked. Up to three
  // `args`, in ER0, ER1 and ER2; the result is in ER0. Errors: more args, ER7 outside RAM, a stop, or
  // no return within `limit` states.
  Result<CallResult> call(std::uint32_t address, std::initializer_list<std::uint32_t> args,
                          States limit = 10'000'000);

  // Text of the instruction at `address`, such as "mov.l @(0x10:16,er6),er0"; `length` is set to its
  // length in bytes.
  std::string disassemble(std::uint32_t address, int* length = nullptr) const;
  const FlashStatistics& flash_statistics() const;
  // Current registers, back-trace and last instructions, as in Stop::report.
  std::string report() const;
  const std::vector<Misuse>& misuse() const;

  // Pins
  // ----

  PortOutput output(Port port) const;
  // Drives a pin from the board, from now() on. `bit` is 0..7; others are ignored.
  void set_input(Port port, int bit, bool level);
  // Stops driving it: the level is the pull-up's if that is on, else Options::floating_level.
  void release_input(Port port, int bit);
  void set_nmi(bool level);

  // Current level and driver of a pin.
  PinState state(Pin pin) const;
  bool level(Pin pin) const { return state(pin).level; }
  // Calls `listener` at each change of the pin's level, input or output, in order of time, with the
  // state at which the edge occurs, also between two instructions or while asleep. With `drivers` also
  // when the pin's driver or pull-up changes. Returns an id for unwatch().
  // A listener may read pins and drive inputs, which takes effect at the time of the edge; it must not
  // run, reset, restore or move the chip. A reset appears at the pins at the instruction boundary before
  // it. Clones are not watched; changes by restore() are not reported.
  // Stale flags: translated code computes flags only where they are read or its block may be left. So in a
  // listener that a MOV or bit instruction to a fixed I/O address calls, H, N, Z, V and C of
  // registers().ccr may be those of any earlier instruction; ER0 to ER7, PC (this instruction's), I, UI and
  // now() are right. They are right between instructions (call_at, code hooks), while an observer is
  // attached, and with the other engines, where a store has already set its own. instructions() may lack
  // those since the last event with any engine. The same holds for on_output, on_transmit and set_analog.
  int watch(Pin pin, PinListener listener, bool drivers = false);
  void unwatch(int watch);
  // Calls `call` once at time `at` (if that is past, at the start of the next run), between
  // instructions, with the rights of a listener. Returns an id for cancel().
  int call_at(States at, std::function<void(States)> call);
  void cancel(int call);
  // Drives an I/O pin, a pin of port 7 or NMI. No effect on the others, which Options define.
  void set_input(Pin pin, bool level);
  void release_input(Pin pin);

  // Called when outputs of ports, PWM, timers or serial channels may have changed.
  void on_output(std::function<void(const OutputChange&)> listener);
  // Duty cycle of PW0..PW15: counts high per 256; 256 or 0 while the port latch (or nothing) drives the
  // pin.
  int pw_high_counts(int channel) const;
  bool pw_driven(int channel) const;
  // Duty cycle of TMO0, TMO1, 0..1, in the timer's steady state; also when the port drives the pin.
  double tmo_high_share(int timer) const;
  bool tmo_driven(int timer) const;

  // Input voltage of AN0..AN7 (8..15: CIN0..CIN7) as a fraction of AVCC, 0..1. `source` is called at the
  // time of each sample. `steady`: it has no effects, and depends on channel, time, outputs and what does
  // not change during a run alone. A scan's samples may then be taken later, but before any output changes
  // and before the run ends; those that nothing reads are not taken.
  void set_analog(std::function<double(int channel, States at)> source, bool steady = false);

  // Serial
  // ------

  // Queues a byte for RxD0 or RxD1. Errors: `byte.at` before now() or before the byte queued last.
  Result<void> receive(int sci, const ReceivedByte& byte);
  // Called when a byte has been transmitted at TxD0 or TxD1.
  void on_transmit(std::function<void(int sci, const TransmittedByte&)> listener);

 private:
  explicit Chip(std::unique_ptr<Machine> machine);
  std::unique_ptr<Machine> machine_;
};

}  // namespace kaz::h8s
