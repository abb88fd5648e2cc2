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

#include "shared/image/error.h"
#include "shared/image/image.h"
#include "sim/h8s/archive.h"
#include "sim/h8s/chip/options.h"
#include "sim/h8s/chip/pins.h"

namespace kaz::h8s {

enum class Port { p1 = 1, p2, p3, p4, p5, p6, p7 };

// Why run_until came back.
struct Stop {
  enum class Reason {
    reached,                 // now() >= until
    breakpoint,              // a code hook asked to stop; the instruction there has not run
    undefined_instruction,   // also: instruction fetch outside flash and RAM
    unmapped_access,         // data access outside flash, RAM and I/O
    stack_outside_ram,       // push, pop, call, return or exception with ER7 outside RAM
    undefined_register_use,  // only with Options::stop_on_misuse
    asleep_forever,          // SLEEP with nothing enabled that could wake it
    requested,               // an observer asked, after the instruction or exception entry it saw
  };
  Reason reason = Reason::reached;
  // Empty for `reached`; else several lines: what, where (symbol), registers, back-trace, last
  // instructions.
  std::string report;
  template <class A>
  void transfer(A& a) {
    a(reason, report);
  }
};

// Levels of a port's pins. A bit that is not `driven` is an input: its level is the board's
// business.
struct PortOutput {
  std::uint8_t level = 0;
  std::uint8_t driven = 0;
  bool operator==(const PortOutput&) const = default;
};

// An output register was written and something at the pins may differ from now on.
struct OutputChange {
  enum class Unit { port, pwm, timer, serial };
  Unit unit = Unit::port;
  // port: 1..6, 0 for all (reset); pwm: channel 0..15, -1 for all; timer: 0, 1 (TMO0, TMO1);
  // serial: 0, 1 (a frame begins on TxD, or clocks on SCK)
  int index = 0;
  States at = 0;
};

// A byte on its way to RxD.
struct ReceivedByte {
  std::uint8_t value = 0;
  States at = 0;  // end of its last stop bit
  bool framing_error = false;
  bool parity_error = false;
  bool multiprocessor = false;  // its multiprocessor bit, where SMR.MP asks for one
  // Its sender's bit time. Where the channel has another one, it hears what that makes of the byte.
  // 0: that of the channel.
  States bit_states = 0;
  template <class A>
  void transfer(A& a) {
    a(value, at, framing_error, parity_error, multiprocessor, bit_states);
  }
};

// A byte that has left TxD.
struct TransmittedByte {
  std::uint8_t value = 0;
  States start = 0;  // beginning of the start bit
  States end = 0;    // end of the last stop bit
};

enum class ResetCause { power_on, pin, watchdog };

// Something the manual forbids or leaves undefined; the chip went on.
struct Misuse {
  std::uint32_t address = 0;  // of the register or memory
  std::uint32_t pc = 0;       // of the instruction
  std::string text;           // one sentence
  std::int64_t count = 0;
  States first = 0;
  template <class A>
  void transfer(A& a) {
    a(address, pc, text, count, first);
  }
};

struct CallResult {
  std::uint32_t er0 = 0;
  States states = 0;  // from the first instruction to the end of RTS
};

// What has been done to the flash since the chip was made.
struct FlashStatistics {
  struct Block {
    std::int64_t erasures = 0;  // pulses that moved cells: wear
    std::int64_t erase_pulses = 0, program_pulses = 0;
    std::int64_t weak_pulses = 0;   // shorter than the manual's
    std::int64_t reprogrammed = 0;  // pulses that programmed a bit which was 0 already
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

// What a code hook wants.
enum class HookAction { go_on, stop };

class Machine;
class Observer;
class InputLog;

class Chip {
 public:
  explicit Chip(const Options& options = {});
  ~Chip();
  Chip(Chip&&) noexcept;
  Chip& operator=(Chip&&) noexcept;

  // A second chip in the same state, without the callbacks, hooks and analog source.
  Chip clone() const;
  // Whole state, to be restored later into this or another chip; callbacks stay as they are.
  std::shared_ptr<const Chip> save() const;
  void restore(const Chip& saved);
  // The same as bytes, for files: of one build, for a chip with the same options. A reader that
  // fails leaves a chip that has to be powered on.
  void write_state(StateWriter& to) const;
  void read_state(StateReader& from);

  // --- program
  // ------------------------------------------------------------------------------------- Puts the
  // image's segments at their load addresses in flash, everything else in flash to 0xff. Does not
  // reset. Errors: a segment outside the flash.
  Result<void> load(const Image& image);
  // For programs started at their entry, not by reset: every section at its run address, in flash
  // (which keeps what is elsewhere) and RAM; PC := `entry`. After power_on. Errors: a section
  // outside flash and RAM.
  Result<void> place(const Image& image, std::uint32_t entry);
  // Adds names without touching memory (S-record image, symbols from the COFF beside it).
  void set_symbols(SymbolTable symbols);
  const SymbolTable& symbols() const;

  // --- running
  // ------------------------------------------------------------------------------------- Power
  // applied: RAM becomes `ram_fill` (real RAM holds anything), then as reset(). Time goes to 0.
  void power_on(std::uint8_t ram_fill = 0xa5);
  // RES pin low and high again, taking no time. RAM is kept. A Stop for an error is forgotten.
  void reset();
  // Levels of MD1, MD0 from the next reset on (Options::mode).
  void set_mode_pins(int mode);
  // The boot ROM runs, not yet what it has loaded.
  bool in_boot_rom() const;
  // Runs until now() >= until (whole instructions) or something stops it. An error stop repeats at
  // each further call until reset.
  Stop run_until(States until);
  // Exactly one instruction or exception entry, or one jump to the next event while asleep.
  // While asleep not beyond `no_later`.
  Stop step(States no_later = std::numeric_limits<States>::max());
  States now() const;
  // Executed since power-on.
  std::int64_t instructions() const;
  // Of those, the ones that ran as translated host code (for measurements; no part of save()).
  std::int64_t translated_instructions() const;
  // The engine that executes: `Options::engine`, but the interpreter where nothing can be translated.
  Engine engine() const;
  bool asleep() const;
  ResetCause reset_cause() const;
  // Called at each reset by a watchdog, before the first instruction.
  void on_watchdog_reset(std::function<void(States)> listener);

  // --- looking and debugging
  // -----------------------------------------------------------------------
  Registers registers() const;
  void set_registers(const Registers& registers);
  // Flash, RAM and registers without side effects and without time. Unmapped: nullopt; for `poke`:
  // false.
  std::optional<std::uint8_t> peek(std::uint32_t address) const;
  std::optional<std::uint16_t> peek16(std::uint32_t address) const;
  std::optional<std::uint32_t> peek32(std::uint32_t address) const;
  bool peek(std::uint32_t address, std::span<std::uint8_t> to) const;
  // Flash and RAM only.
  bool poke(std::uint32_t address, std::uint8_t value);
  bool poke(std::uint32_t address, std::span<const std::uint8_t> from);

  // Calls `hook` each time just before the instruction at `address` runs. One hook an address.
  using CodeHook = std::function<HookAction(Chip&)>;
  void set_hook(std::uint32_t address, CodeHook hook);
  void set_breakpoint(std::uint32_t address);
  void clear_hook(std::uint32_t address);

  // Looks on from now until detached or either is gone (detach first); see debug/observer.h. While
  // there are observers the chip runs slower, with the same results. Not part of save() or clone().
  void attach(Observer& observer);
  void detach(Observer& observer);
  // For observers: ends run_until or step at the next boundary with Stop::Reason::requested.
  void request_stop();
  // Tells `log` of all that comes from outside from now on; null: nobody. debug/history.h uses it.
  void set_input_log(InputLog* log);

  // Runs the function at `address` of the image as C would call it, on this chip (use a clone),
  // with interrupts masked: args in ER0, ER1, ER2, result in ER0. Errors: it stopped, or took over
  // `limit`.
  Result<CallResult> call(std::uint32_t address, std::initializer_list<std::uint32_t> args,
                          States limit = 10'000'000);

  // "mov.l @(0x10:16,er6),er0"; text of one instruction at `address`, and its length in bytes.
  std::string disassemble(std::uint32_t address, int* length = nullptr) const;
  const FlashStatistics& flash_statistics() const;
  // Registers, back-trace and last instructions as of now.
  std::string report() const;
  const std::vector<Misuse>& misuse() const;

  // --- pins
  // ----------------------------------------------------------------------------------------
  PortOutput output(Port port) const;
  // Level that the board gives to a pin; matters where the chip reads it. Takes effect at now().
  void set_input(Port port, int bit, bool level);
  // The board lets go: pull-up if switched on, else Options::floating_level.
  void release_input(Port port, int bit);
  void set_nmi(bool level);

  // What a pin shows now, and who makes it do so.
  PinState state(Pin pin) const;
  bool level(Pin pin) const { return state(pin).level; }
  // Tells each change of a pin's level, output or input, with the state at which it happens, in the
  // order of states; also those between two instructions or while asleep. `drivers`: changes of who
  // drives the pin, and of its pull-up, too. Listeners run as the edge happens: they may look at pins
  // and drive inputs, which takes effect at the edge's state, and must not run, reset, restore or
  // move the chip. A reset shows at the pins at the instruction boundary before it. Watching costs
  // time only while something is watched. Gives a number for unwatch(). Copies of the chip are not
  // watched, and what restore() changes at the pins is not told.
  int watch(Pin pin, PinListener listener, bool drivers = false);
  void unwatch(int watch);
  // Calls once at that state (at once in the next run if it is past), between what the instructions
  // do; for what a listener may do. Gives a number for cancel().
  int call_at(States at, std::function<void(States)> call);
  void cancel(int call);
  // Drives an I/O pin, port 7 or NMI; others are fixed by Options, and nothing happens.
  void set_input(Pin pin, bool level);
  void release_input(Pin pin);

  // One listener for ports, PWM and timer outputs.
  void on_output(std::function<void(const OutputChange&)> listener);
  // High counts of PW0..PW15 per 256; 256 or 0 while the port latch (or nothing) drives the pin.
  int pw_high_counts(int channel) const;
  bool pw_driven(int channel) const;
  // Share of time that TMO0, TMO1 is high, 0..1, once the timer has settled; also when the port
  // drives it.
  double tmo_high_share(int timer) const;
  bool tmo_driven(int timer) const;

  // Input voltage of AN0..AN7 (8..15: CIN0..CIN7) as a share of AVCC, asked as the converter
  // samples.
  void set_analog(std::function<double(int channel, States at)> source);

  // --- serial
  // -------------------------------------------------------------------------------------- A byte
  // for RxD0 or RxD1. Errors: before now() or before the one queued last.
  Result<void> receive(int sci, const ReceivedByte& byte);
  // Called when a byte has left TxD0 or TxD1.
  void on_transmit(std::function<void(int sci, const TransmittedByte&)> listener);

 private:
  explicit Chip(std::unique_ptr<Machine> machine);
  std::unique_ptr<Machine> machine_;
};

}  // namespace kaz::h8s
