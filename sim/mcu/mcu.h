// The microcontroller of the servo board, as its pins see it.
// SPDX-License-Identifier: Apache-2.0
//
// Two engines implement it: `h8` executes the firmware image instruction by instruction, `native`
// runs the same C compiled for the PC.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "shared/servo/tick.h"
#include "sim/mcu/archive.h"

namespace kaz::sim {

// Time on the board, in periods of its crystal (18.432 MHz) since power was first applied.
using States = std::int64_t;

// What the chip drives. A pin that is an input, or floats during reset, stands at the level that
// the board's pull resistor gives it (multiplexer selects high, everything else low).
struct PinLevels {
  std::array<std::uint16_t, 16> pw{};  // high counts out of 256 of PW0..PW15; 256: constant high
  std::array<std::uint16_t, 2> tmo{};  // the same for TMO0, TMO1
  std::uint8_t p3 = 0, p4 = 0x07, p5 = 0, p6 = 0;
  bool operator==(const PinLevels&) const = default;
  template <class A>
  void transfer(A& a) {
    a(pw, tmo, p3, p4, p5, p6);
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
  }
};

// What happened in one tick, at the boundary of shared/servo.
struct TickRecord {
  kz_tick_input input;
  kz_tick_output output;
};

class Mcu {
 public:
  virtual ~Mcu() = default;

  // "h8" or "native".
  virtual std::string name() const = 0;
  // h8: the engine that the emulator executes with, "translator" by default; native: empty.
  virtual std::string emulator_engine() const { return {}; }
  virtual States now() const = 0;

  // Runs until `now() >= until`. Fails, once and for all until the next reset, when the chip does
  // something no program should: undefined instruction, unmapped access, stack outside RAM. The
  // message says where.
  virtual Result<void> run_until(States until) = 0;

  virtual void reset() = 0;        // RES pin; RAM is kept
  virtual void power_cycle() = 0;  // everything but flash is lost

  // The mode pins say boot mode, or to run what is in flash: from the next reset on. h8 only.
  virtual Result<void> set_boot_pins(bool boot) {
    if (!boot) return {};
    return fail(Fault::usage, "the mcu \"" + name() + "\" has no boot mode; h8 has");
  }
  // The boot ROM runs, not yet what it has loaded.
  virtual bool in_boot_rom() const { return false; }
  // With a listener a chip that does what no program should hangs until reset, and run_until()
  // does not fail.
  virtual void on_hang(std::function<void(const std::string& report)> listener) { (void)listener; }

  // What the board remembers without power: flash blocks EB1 to EB3, calibration and address
  // (shared/servo/store.h). Setting it takes effect at the next reset.
  static constexpr std::size_t memory_size = 3072;
  virtual std::array<std::uint8_t, memory_size> memory() const = 0;
  virtual void set_memory(std::span<const std::uint8_t, memory_size> bytes) = 0;

  // State of the servo behind the last tick, where it is in this process's layout: native only, else
  // null.
  virtual const struct kz_servo* servo() const { return nullptr; }

  virtual const PinLevels& pins() const = 0;
  // Called at each change of a pin, with the exact time. One listener.
  virtual void on_pins(std::function<void(States, const PinLevels&)> listener) = 0;

  // Voltage at AN0..AN7 as a share of AVCC, asked at the moment the converter samples. `levels`
  // tell where the multiplexer selects stand then.
  using AnalogSource = std::function<double(int channel, const PinLevels& levels, States at)>;
  virtual void set_analog(AnalogSource source) = 0;

  // Bytes for RxD0; times must not decrease nor lie in the past.
  virtual void receive(const SerialByte& byte) = 0;
  // Bytes that left TxD0 since the last call, each with the time of its last stop bit.
  virtual std::vector<SerialByte> take_transmitted() = 0;

  // Called after each tick's computation. Used to compare the engines and to record.
  virtual void on_tick(std::function<void(const TickRecord&)> listener) = 0;

  // Called when the chip's own watchdog has reset it, which it does on request too (reset, loader);
  // with the native engine only on request.
  virtual void on_watchdog_reset(std::function<void(States)> listener) { (void)listener; }

  // All that the chip remembers; listeners and the analog source stay as they are. The archive
  // fails where an engine cannot.
  virtual void save(StateWriter& to) { to.refuse("this engine cannot be saved"); }
  virtual void restore(StateReader& from) { from.refuse("this engine cannot be restored"); }
};

// The firmware image: S-record or COFF. With symbols (COFF) reports are readable and `on_tick`
// works; for an S-record the symbols are looked for in a file of the same name ending in `.coff`.
Result<std::unique_ptr<Mcu>> make_h8(const std::string& image_path);
// A chip as it comes from the factory.
std::unique_ptr<Mcu> make_erased_h8();
std::unique_ptr<Mcu> make_native();

}  // namespace kaz::sim
