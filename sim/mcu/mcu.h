// Interface of the servo board's microcontroller, as seen from the pins.
// SPDX-License-Identifier: Apache-2.0
//
// Two engines implement this interface: `h8` executes the firmware image instruction by instruction, `native`
// runs the firmware's C code, compiled for the PC.
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

// Time since power was first applied to the board, in periods of the board's crystal (18.432 MHz).
using States = std::int64_t;

// Levels at the chip's output pins. If a pin is an input, or floats during reset, the board's pull resistor
// determines the level of the pin. These resistors pull the select pins of the multiplexers high and all
// other pins low.
struct PinLevels {
  std::array<std::uint16_t, 16> pw{};  // PW0..PW15: number of high counts out of 256
  std::array<std::uint16_t, 2> tmo{};  // TMO0 and TMO1: number of high counts out of 256
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
  States at = 0;  // end of the stop bit
  bool framing_error = false;
  States bit_states = KZ_STATES_PER_BIT;  // bit time of the sender
  template <class A>
  void transfer(A& a) {
    a(value, at, framing_error, bit_states);
    a.require(bit_states > 0, "bit time");
  }
};

// Input and output of one tick of shared/servo.
struct TickRecord {
  kz_tick_input input;
  kz_tick_output output;
};

class Mcu {
 public:
  virtual ~Mcu() = default;

  // Returns the name of the McuKind; test doubles have other names.
  virtual std::string name() const = 0;
  // Returns the name of the engine that the emulator uses, such as "translator". The name is empty for the
  // engine `native`.
  virtual std::string emulator_engine() const { return {}; }
  virtual States now() const = 0;

  // Runs until `now() >= until`. Fails on an undefined instruction, an unmapped access or a stack outside
  // RAM. After a failure, all calls of run_until() before the next reset return the same error. The error
  // message contains the location.
  virtual Result<void> run_until(States until) = 0;

  virtual void reset() = 0;        // resets by the RES pin; RAM is kept
  virtual void power_cycle() = 0;  // the whole state except flash is lost

  // Sets the mode pins. If `boot` is true, the pins select boot mode; otherwise the pins select execution
  // from flash. The next reset samples these pins. Engines other than h8 return Fault::usage for boot mode.
  virtual Result<void> set_boot_pins(bool boot) {
    if (!boot) return {};
    return fail(Fault::usage, "the mcu \"" + name() + "\" has no boot mode; use h8");
  }
  // Returns true while the boot ROM runs, and false after the boot ROM has started the downloaded program.
  virtual bool in_boot_rom() const { return false; }
  // Sets the listener for chip errors. If a listener is set, an error hangs the chip until the next reset,
  // and run_until() does not fail.
  virtual void on_hang(std::function<void(const std::string& report)> listener) { (void)listener; }

  // Non-volatile memory: flash blocks EB1 to EB3, which store calibration and board address
  // (shared/servo/store.h). set_memory() takes effect at the next reset.
  static constexpr std::size_t kMemorySize = 3072;
  virtual std::array<std::uint8_t, kMemorySize> memory() const = 0;
  virtual void set_memory(std::span<const std::uint8_t, kMemorySize> bytes) = 0;

  // Returns the servo's state after the last tick, in the memory layout of this process. Engines other than
  // native return null.
  virtual const struct kz_servo* servo() const { return nullptr; }

  virtual const PinLevels& pins() const = 0;
  // Sets the listener for changes of pin levels. The listener gets the exact time of each change. Replaces an
  // earlier listener.
  virtual void on_pins(std::function<void(States, const PinLevels&)> listener) = 0;

  // Returns the voltage at AN0..AN7 as a fraction of AVCC, 0..1, at the sample time `at`. `levels` contains
  // the levels of the multiplexers' select pins at that time. If the program cannot read a sample, the
  // engine does not call the function for this sample. Therefore the function must have no side effects. The
  // function's result may depend on the arguments and on other values. During a call of run_until(), only a
  // listener may change these other values.
  using AnalogSource = std::function<double(int channel, const PinLevels& levels, States at)>;
  virtual void set_analog(AnalogSource source) = 0;

  // Queues a byte for RxD0. Times must not decrease and must not be in the past.
  virtual void receive(const SerialByte& byte) = 0;
  // Removes and returns the bytes whose stop bit has ended at TxD0.
  virtual std::vector<SerialByte> take_transmitted() = 0;

  // Sets the listener that is called at the end of each tick's computation. Comparisons of the engines and
  // recordings use this listener.
  virtual void on_tick(std::function<void(const TickRecord&)> listener) = 0;

  // Sets the listener for resets by the chip's watchdog. The firmware also uses the watchdog for requested
  // resets and for starting the loader. The native engine reports only these two kinds of reset.
  virtual void on_watchdog_reset(std::function<void(States)> listener) { (void)listener; }

  // Saves or restores the whole state of the chip. Listeners and the analog source are kept. The archive
  // reports an error if the engine does not support saving, or if the bytes are not a valid state. After a
  // failure of restore(), the native board is unchanged, and the h8 board is powered on with undefined flash
  // contents.
  virtual void save(StateWriter& to) { to.refuse("this engine cannot be saved"); }
  virtual void restore(StateReader& from) { from.refuse("this engine cannot be restored"); }

  // keep() and take() are alternatives to save() and restore(). If many chips of one process continue from
  // the same state, keep() and take() are faster than save() and restore(). keep() returns an object with
  // the parts of the state that are slow to restore from bytes. The rest of the state is written to `to`. If
  // keep() returns null, `to` gets the whole state. Several chips may call take() with the same object
  // concurrently.
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

// Makes an h8 engine with a firmware image: S-record or COFF. The symbols of an S-record are read from the
// file with the same name and the extension `.coff`. Without symbols, error messages show addresses without
// the names of functions. Without symbols, the listener of on_tick() is never called. Returns Fault::usage if
// the image cannot be read.
Result<std::unique_ptr<Mcu>> make_h8(const std::string& image_path);
// Makes an h8 engine with erased flash.
std::unique_ptr<Mcu> make_erased_h8();
// Makes a native engine with blank non-volatile memory.
std::unique_ptr<Mcu> make_native();

}  // namespace kaz::sim
