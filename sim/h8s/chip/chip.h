// Public interface of the emulator. The emulator simulates the H8S/2128 with its peripherals. Instruction
// times are exact.
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

// I/O ports by number (hardware manual, "I/O Ports"). Port 7 is input only.
enum class Port { p1 = 1, p2, p3, p4, p5, p6, p7 };

// Reason why run_until or step returned.
struct Stop {
  enum class Reason {
    reached,     // now() >= until
    breakpoint,  // a code hook returned HookAction::stop; the hook's instruction has not run
    undefined_instruction,   // undefined instruction, or fetch outside flash and RAM
    unmapped_access,         // data access outside flash, RAM and I/O
    stack_outside_ram,       // push, pop, call, return or exception with ER7 outside RAM
    undefined_register_use,  // only with Options::stop_on_misuse
    asleep_forever,          // SLEEP that no enabled interrupt source can end
    requested,               // Chip::request_stop was called before this instruction boundary
  };
  friend constexpr Reason last_value(Reason) { return Reason::requested; }
  Reason reason = Reason::reached;
  // Text of several lines: error, symbol, registers, back-trace, last instructions. Empty for `reached`.
  std::string report;
  template <class A>
  void transfer(A& a) {
    a(reason, report);
  }
};

// Output levels of a port; bit n is pin n. If a pin's bit in `driven` is 0, the pin is an input, and the
// pin's bit in `level` is 0.
struct PortOutput {
  std::uint8_t level = 0;
  std::uint8_t driven = 0;
  bool operator==(const PortOutput&) const = default;
};

// Notification that the output pins of a unit can change at the time `at` or later.
struct OutputChange {
  enum class Unit { port, pwm, timer, serial };
  Unit unit = Unit::port;
  // Unit::port: port number 1..6, or 0 for all ports. Unit::pwm: channel 0..15, or -1 for all channels.
  // Unit::timer: 0 (TMO0) or 1 (TMO1). Unit::serial: channel 0 or 1. A serial output changes when a frame
  // begins at TxD or clock pulses begin at SCK.
  int index = 0;
  States at = 0;
};

// Input of Chip::receive: a byte that arrives at RxD.
struct ReceivedByte {
  std::uint8_t value = 0;
  States at = 0;  // end of the byte's last stop bit
  bool framing_error = false;
  bool parity_error = false;
  bool multiprocessor = false;  // value of the multiprocessor bit, if SMR.MP enables that bit
  // Bit time of the sender, states. 0: the sender has the bit time of the channel. If the bit times of sender
  // and channel differ, the channel samples the sender's waveform at the channel's bit times (line_rate.h).
  // If the channel's frames do not have 10 bits, the channel ignores bit_states. The boot ROM's bit rate
  // measurement ignores a byte whose bit_states is 0.
  States bit_states = 0;
  template <class A>
  void transfer(A& a) {
    a(value, at, framing_error, parity_error, multiprocessor, bit_states);
    a.require(bit_states >= 0, "bit time");
  }
};

// A byte that was transmitted at TxD, as it appears on the line.
struct TransmittedByte {
  std::uint8_t value = 0;
  States start = 0;  // beginning of the start bit
  States end = 0;    // end of the last stop bit
};

enum class ResetCause { power_on, pin, watchdog };
constexpr ResetCause last_value(ResetCause) {
  return ResetCause::watchdog;
}

// A register access that the manual forbids, or whose effect the manual does not define. Execution continues
// unless Options::stop_on_misuse is set. Repetitions of the same misuse are counted in one entry.
struct Misuse {
  std::uint32_t address = 0;  // address of the register or memory
  std::uint32_t pc = 0;       // address of the instruction
  std::string text;           // one sentence
  std::int64_t count = 0;
  States first = 0;  // time of the first occurrence
  template <class A>
  void transfer(A& a) {
    a(address, pc, text, count, first);
  }
};

// Result of Chip::call.
struct CallResult {
  std::uint32_t er0 = 0;
  States states = 0;  // duration from the first instruction to the end of RTS
};

// Numbers of erase and program operations since the chip was created (hardware manual, "ROM").
struct FlashStatistics {
  struct Block {
    std::int64_t erasures = 0;  // number of erase pulses that changed cells and thus wore the block
    std::int64_t erase_pulses = 0, program_pulses = 0;
    std::int64_t weak_pulses = 0;   // number of pulses shorter than the manual's minimum
    std::int64_t reprogrammed = 0;  // number of pulses that programmed a bit that was already 0
    template <class A>
    void transfer(A& a) {
      a(erasures, erase_pulses, program_pulses, weak_pulses, reprogrammed);
    }
  };
  std::array<Block, 10> blocks{};  // EB0..EB9
  std::int64_t errors = 0;         // number of times that FLER was set
  template <class A>
  void transfer(A& a) {
    a(blocks, errors);
  }
};

// Result of a code hook: run_until continues or stops.
enum class HookAction { go_on, stop };

class Machine;
class Observer;
class InputLog;

// Addresses have 24 bits, or 16 bits in normal mode. Higher bits are ignored. Times are numbers of states
// since power-on. Only one thread at a time may use a chip. Different chips are independent.
class Chip {
 public:
  explicit Chip(const Options& options = {});
  ~Chip();
  Chip(Chip&&) noexcept;
  Chip& operator=(Chip&&) noexcept;

  // Returns a copy of this chip and its state. The copy has no callbacks, hooks, observers or analog source.
  Chip clone() const;
  // Returns a snapshot of the complete state, for restore() of this or another chip. The snapshot contains
  // neither callbacks nor hooks. When restore() is called, the chip keeps its own callbacks and hooks.
  std::shared_ptr<const Chip> save() const;
  void restore(const Chip& saved);
  // Write and read the complete state as bytes, for files. Only the build that has written the bytes can read
  // these bytes. The reading chip must have the same options as the writing chip. If the reader reports an
  // error, the chip is powered on with undefined flash contents.
  void write_state(StateWriter& to) const;
  void read_state(StateReader& from);

  // Program
  // -------

  // Writes the image's segments to flash at their load addresses and fills the rest of the flash with 0xff.
  // Does not reset the chip. If a segment is outside the flash, returns an error and writes nothing.
  Result<void> load(const Image& image);
  // Loads a program that starts at its entry point, without a reset. Writes every section to its run address
  // in flash or RAM and sets PC to `entry`. Other memory is unchanged. Must be called after power_on. If a
  // section is outside flash and RAM, returns an error. After this error, memory can already contain some
  // sections of the program.
  Result<void> place(const Image& image, std::uint32_t entry);
  // Sets the symbols that reports use. An S-record image has no symbols; the symbols can come from a COFF
  // file.
  void set_symbols(SymbolTable symbols);
  const SymbolTable& symbols() const;

  // Execution
  // ---------

  // Fills RAM with `ram_fill`, sets the time to 0 and resets. In a real chip, the contents of RAM after
  // power-on are random.
  void power_on(std::uint8_t ram_fill = 0xa5);
  // Resets the chip by a pulse of zero length at the RES pin. The contents of RAM are kept. A chip that
  // an error has stopped can run again after a reset.
  void reset();
  // Sets the levels of MD1 and MD0 (Options::mode), which the next reset samples.
  void set_mode_pins(int mode);
  // Returns true from a reset in boot mode until the boot ROM starts the downloaded program.
  bool in_boot_rom() const;
  // Runs whole instructions. Returns when now() >= until. Stop::Reason lists the reasons for which the
  // function returns earlier. After an error, each further call returns the Stop of the error until a reset.
  Stop run_until(States until);
  // Runs one instruction, exception entry or DTC activation. If the CPU is asleep, advances to the next
  // event, but not beyond the time `no_later`.
  Stop step(States no_later = std::numeric_limits<States>::max());
  States now() const;
  // Returns the number of instructions executed since power-on.
  std::int64_t instructions() const;
  // Returns how many of the executed instructions ran as translated host code. The number is for measurements
  // and is not part of save().
  std::int64_t translated_instructions() const;
  // Returns the engine in use. In normal mode and in builds without the translator, the chip uses the
  // interpreter instead of the translator. Otherwise, the engine in use is Options::engine.
  Engine engine() const;
  bool asleep() const;
  ResetCause reset_cause() const;
  // Sets the listener for watchdog resets. The listener is called with the time of the reset, before the
  // first instruction after the reset.
  void on_watchdog_reset(std::function<void(States)> listener);

  // Inspection and debugging
  // ------------------------

  Registers registers() const;  // in a listener, flags may be stale (see watch())
  void set_registers(const Registers& registers);
  // Read flash, RAM and I/O registers. A read has no side effects and takes no time. These functions return
  // nullopt or false at an unmapped address.
  std::optional<std::uint8_t> peek(std::uint32_t address) const;
  std::optional<std::uint16_t> peek16(std::uint32_t address) const;
  std::optional<std::uint32_t> peek32(std::uint32_t address) const;
  bool peek(std::uint32_t address, std::span<std::uint8_t> to) const;
  // Write flash or RAM, but not I/O registers. A write takes no time. These functions return false if an
  // address is outside flash and RAM; the bytes before that address have then been written.
  bool poke(std::uint32_t address, std::uint8_t value);
  bool poke(std::uint32_t address, std::span<const std::uint8_t> from);

  // Calls `hook` each time before the instruction at `address` runs. Replaces an earlier hook at that
  // address. A hook must not run this chip, but may run a clone.
  using CodeHook = std::function<HookAction(Chip&)>;
  void set_hook(std::uint32_t address, CodeHook hook);
  void set_breakpoint(std::uint32_t address);
  void clear_hook(std::uint32_t address);

  // Notifies `observer` (observer.h) until detach(). Call detach() before the observer or the chip is
  // destroyed. An observed chip runs slower, but has the same results. Observers are not part of save() or
  // clone().
  void attach(Observer& observer);
  void detach(Observer& observer);
  // Ends run_until or step at the next instruction boundary with Reason::requested. Intended for observers.
  void request_stop();
  // Reports all external input to `log`, for replay by debug/history.h. Null disables the log. `log` must
  // live until the chip is destroyed or another log is set.
  void set_input_log(InputLog* log);

  // Calls a C function of the image with interrupts masked. The call changes the state of the chip. To leave
  // this chip unchanged, call the function on a clone. Up to three `args` go to ER0, ER1 and ER2; the result
  // is in ER0. Errors: there are more than three args, ER7 is outside RAM, the chip stops, or the function
  // does not return within `limit` states.
  Result<CallResult> call(std::uint32_t address, std::initializer_list<std::uint32_t> args,
                          States limit = 10'000'000);

  // Returns the text of the instruction at `address`, such as "mov.l @(0x10:16,er6),er0". `length` receives
  // the instruction's length in bytes and may be null.
  std::string disassemble(std::uint32_t address, int* length = nullptr) const;
  const FlashStatistics& flash_statistics() const;
  // Returns a text with registers, back-trace and last instructions, like Stop::report.
  std::string report() const;
  // Returns the first 256 different misuses since power-on.
  const std::vector<Misuse>& misuse() const;

  // Pins
  // ----

  PortOutput output(Port port) const;
  // Lets the board drive a pin, beginning at now(). `bit` is 0..7; other values are ignored.
  void set_input(Port port, int bit, bool level);
  // The board stops driving the pin. A released input pin is high if its pull-up is on. Without a pull-up, a
  // released input pin has the level Options::floating_level.
  void release_input(Port port, int bit);
  void set_nmi(bool level);

  // Returns the current level, driver and pull-up of a pin.
  PinState state(Pin pin) const;
  bool level(Pin pin) const { return state(pin).level; }
  // Calls `listener` at each change of the pin's level, for inputs and outputs, with the exact time of the
  // edge. The calls are in the order of the edges' times. Edges that no instruction causes are also reported,
  // for example edges during sleep. If `drivers` is true, a change of the pin's driver or pull-up also causes
  // a call. Returns an id for unwatch().
  //
  // A listener may read pins and drive inputs. The driven inputs change at the time of the edge. A listener
  // must not run, reset, restore or move the chip. If a reset causes an edge, the reported time of the edge
  // is the beginning of the reset. Clones are not watched, and changes by restore() are not reported.
  //
  // A listener can read stale (outdated) flags. Reason: translated code does not compute the flags after
  // every instruction. If a MOV or bit instruction with a fixed I/O address causes the call, the flags H, N,
  // Z, V and C in registers().ccr can be outdated. The other values are valid: ER0 to ER7, I, UI, now() and
  // PC (the address of the instruction that causes the call). All flags are valid in code hooks and while an
  // observer is attached. The engines `reference` and `interpreter` update the flags before each call, so all
  // flags are valid. During a call, the result of instructions() can be too low, because the chip does not
  // update the count after every instruction. These limits also apply in the callbacks of on_output,
  // on_transmit and set_analog.
  int watch(Pin pin, PinListener listener, bool drivers = false);
  void unwatch(int watch);
  // Calls the function `call` once, at the time `at`. The argument of the call is the time. If `at` is in the
  // past, the call is made at the start of the next run. The rules for `call` are the same as for a listener
  // of watch(). Returns an id for cancel().
  int call_at(States at, std::function<void(States)> call);
  void cancel(int call);
  // The function set_input drives an I/O pin, a pin of port 7, or NMI. The function release_input releases an
  // I/O pin or a pin of port 7. Calls with another pin have no effect.
  void set_input(Pin pin, bool level);
  void release_input(Pin pin);

  // Sets the listener for changes of the outputs of ports, PWM, timers and serial channels.
  void on_output(std::function<void(const OutputChange&)> listener);
  // Returns the duty cycle of PW0..PW15 as the number of high counts out of 256. If the port latch or TxD
  // drives the pin, the result is 256 while the pin is high and 0 while the pin is low. If the pin is an
  // input, the result is 0.
  int pw_high_counts(int channel) const;
  bool pw_driven(int channel) const;
  // Returns the duty cycle 0..1 of TMO0 or TMO1 in the timer's steady state. If the port drives the pin, the
  // result is the level of the pin, 0 or 1. If the pin is an input, the result is 0.
  double tmo_high_share(int timer) const;
  bool tmo_driven(int timer) const;

  // Sets the source of input voltages, as fractions of AVCC (0..1). Channels 0..7 are AN0..AN7, 8..15 are
  // CIN0..CIN7. `source` is called at the time of each sample. Without a source all voltages are 0.
  //
  // If the caller sets `steady`, `source` must have no side effects. With `steady`, a voltage may depend only
  // on the time, the chip's non-serial outputs, and values that are constant during a run. In scan mode with
  // `steady`, the chip can call `source` later than the time of the sample. The chip makes this call before
  // the next change of a non-serial output, and before the end of the run. The chip skips samples whose
  // results the program does not read.
  void set_analog(std::function<double(int channel, States at)> source, bool steady = false);

  // Serial
  // ------

  // Queues a byte for RxD0 or RxD1. Errors: `sci` is not 0 or 1, or `byte.at` is before now() or before the
  // last queued byte.
  Result<void> receive(int sci, const ReceivedByte& byte);
  // Sets the listener for bytes transmitted at TxD0 or TxD1. The listener is called after the byte's last
  // stop bit.
  void on_transmit(std::function<void(int sci, const TransmittedByte&)> listener);

 private:
  explicit Chip(std::unique_ptr<Machine> machine);
  std::unique_ptr<Machine> machine_;
};

}  // namespace kaz::h8s
