// The microcontroller of the servo board, seen from its pins.
// SPDX-License-Identifier: Apache-2.0
//
// Two engines implement it: `h8` executes the firmware image instruction by instruction, `native`
// runs the same C compiled for the PC.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shared/base/archive.hpp"
#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "shared/servo/tick.h"
#include "sim/mcu/mcu_kind.h"

namespace kaz::sim {

// Time on the board, in periods of its crystal (18.432 MHz) since power was first applied.
using States = std::int64_t;

// Levels driven by the chip. A pin that is an input, or floats during reset, has the level of the board's
// pull resistor (multiplexer selects high, everything else low).
struct PinLevels {
  std::array<std::uint16_t, 16> pw{};  // high counts out of 256 of PW0..PW15; 256: constant high
  std::array<std::uint16_t, 2> tmo{};  // the same for TMO0, TMO1
  std::uint8_t p3 = 0, p4 = 0x07, p5 = 0, p6 = 0;
  bool operator==(const PinLevels&) const = default;
  template <class A>
  void transfer(A& a) {
    a(pw, tmo, p3, p4, p5, p6);
    const auto fits = [](std::uint16_t counts) { return counts <= 256; };
    a.require(std::ranges::all_of(pw, fits) && std::ranges::all_of(tmo, fits), "pin");
  }
};

struct SerialByte {
  std::uint8_t value = 0;
  States at = 0;  // when its last stop bit has passed
  bool framing_error = false;
  States bit_states = KZ_STATES_PER_BIT;  // its sender's bit time
  template <class A>
  void transfer(A& a) {
    a(value, at, framing_error, bit_states);
    a.require(bit_states > 0, "bit time");
  }
};

// Input and output of one tick, at the interface of shared/servo.
struct TickRecord {
  kz_tick_input input;
  kz_tick_output output;
};

class Mcu {
 public:
  virtual ~Mcu() = default;

  // That of its McuKind; test doubles have others.
  virtual std::string name() const = 0;
  // h8: the engine that the emulator executes with, "translator" by default; native: empty.
  virtual std::string emulator_engine() const { return {}; }
  virtual States now() const = 0;

  // Runs until `now() >= until`. Errors, repeated until the next reset: undefined instruction, unmapped
  // access, stack outside RAM; the message contains the location.
  virtual Result<void> run_until(States until) = 0;

  virtual void reset() = 0;        // RES pin; RAM is kept
  virtual void power_cycle() = 0;  // everything but flash is lost

  // Sets the mode pins to boot mode or to running from flash, effective at the next reset. h8 only.
  virtual Result<void> set_boot_pins(bool boot) {
    if (!boot) return {};
    return fail(Fault::usage, "the mcu \"" + name() + "\" has no boot mode; h8 has");
  }
  // True while the boot ROM runs, false once it has started the downloaded program.
  virtual bool in_boot_rom() const { return false; }
  // With a listener, a chip error hangs the chip until reset instead of failing run_until().
  virtual void on_hang(std::function<void(const std::string& report)> listener) { (void)listener; }

  // Non-volatile memory: flash blocks EB1 to EB3 with calibration and address (shared/servo/store.h).
  // Setting it takes effect at the next reset.
  static constexpr std::size_t memory_size = 3072;
  virtual std::array<std::uint8_t, memory_size> memory() const = 0;
  virtual void set_memory(std::span<const std::uint8_t, memory_size> bytes) = 0;

  // State of the servo after the last tick, in this process's memory layout: native only, else null.
  virtual const struct kz_servo* servo() const { return nullptr; }

  virtual const PinLevels& pins() const = 0;
  // Called at each change of a pin, with its exact time. One listener.
  virtual void on_pins(std::function<void(States, const PinLevels&)> listener) = 0;

  // Voltage at AN0..AN7 as a fraction of AVCC, 0..1, at the converter's sample `at`. `levels` contains the
  // multiplexer selects at that time. The source has no effects, and depends on its arguments and on what
  // changes between runs or in listeners alone: samples that the program cannot read are not taken.
  using AnalogSource = std::function<double(int channel, const PinLevels& levels, States at)>;
  virtual void set_analog(AnalogSource source) = 0;

  // Bytes for RxD0; times must not decrease nor be in the past.
  virtual void receive(const SerialByte& byte) = 0;
  // Bytes that left TxD0 since the last call, each with the time of its last stop bit.
  virtual std::vector<SerialByte> take_transmitted() = 0;

  // Called after each tick's computation. Used to compare the engines and to record.
  virtual void on_tick(std::function<void(const TickRecord&)> listener) = 0;

  // Called when the chip's watchdog has reset it, which also serves requests for reset or loader; with the
  // native engine only on such requests.
  virtual void on_watchdog_reset(std::function<void(States)> listener) { (void)listener; }

  // The chip's whole state; listeners and the analog source are kept. The archive fails if the engine does
  // not support it, or if the bytes are those of no state; the native board is then as before, the other one
  // has been powered on, with undefined flash.
  virtual void save(StateWriter& to) { to.refuse("this engine cannot be saved"); }
  virtual void restore(StateReader& from) { from.refuse("this engine cannot be restored"); }

  // The same for many chips of a process that go on from one state: what takes long to read from bytes is in
  // the returned object, the rest is in `to`. Null: all is in `to`. Several may take() from one at once.
  struct Kept {
    virtual ~Kept() = default;
  };
  virtual std::unique_ptr<const Kept> keep(StateWriter& to) {
    save(to);
    return nullptr;
  }
  virtual void take(StateReader& from, const Kept* kept) {
    static_cast<void>(kept);
    restore(from);
  }
};

// The firmware image: S-record or COFF. With symbols (COFF) reports are readable and `on_tick`
// works; the symbols of an S-record are read from a file of the same name ending in `.coff`.
Result<std::unique_ptr<Mcu>> make_h8(const std::string& image_path);
// The native engine, with blank non-volatile memory.
std::unique_ptr<Mcu> make_erased_h8();
std::unique_ptr<Mcu> make_native();

}  // namespace kaz::sim
