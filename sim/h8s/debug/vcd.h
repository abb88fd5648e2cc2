// Records pins, registers and memory to a VCD file (IEEE 1364), for GTKWave and similar viewers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/h8s/chip/chip.h"

namespace kaz::h8s {

// Default clock: states per second of the servo board.
inline constexpr std::int64_t kDefaultHertz = 18'432'000;

// Returns the time from state 0 to `at` in picoseconds, rounded to the nearest integer.
std::int64_t picoseconds(States at, std::int64_t hertz);

// Names of signals:
// - A pin by any name ("P50", "TxD0"), or "pins" for all pins.
// - er0..er7, sp, pc, ccr, exr, or "cpu" for all CPU registers.
// - An I/O register ("FRC", "SSR0"; registers.h).
// - Memory by symbol or address, with its width in bits: "_tick:16", "0xffe100:8". The default width is 8.
//
// Pins change at their exact states. The value of a pin is '0' or '1', or 'z' if neither a driver nor a
// pull-up is active. P46 has the value 'x' while this pin outputs the clock. Registers and memory are sampled
// at each instruction boundary. If a value has changed, the new value is written. If two registers share an
// address, control bits of the chip determine the selected register. Only the selected register is sampled.
// The other register keeps its last value, or 'x' before its first sample.
//
// The recorder never rewrites entries. If the chip is restored to an earlier state, the recorder adds no
// entries until the chip has passed the time of the last entry.
class VcdRecorder {
 public:
  // Starts a recording in a temporary file in the folder of `path`. close() ends the recording and renames
  // the file to `path`. `chip` must outlive this object and must not be moved. `hertz`: states per second.
  // Errors: `names` is empty, a name is unknown, a register is write-only, or the file cannot be created.
  static Result<std::unique_ptr<VcdRecorder>> open(Chip& chip,
                                                   const std::vector<std::string>& names,
                                                   const std::string& path,
                                                   std::int64_t hertz = kDefaultHertz);
  // Records to a stream, which must outlive this object.
  static Result<std::unique_ptr<VcdRecorder>> open(Chip& chip,
                                                   const std::vector<std::string>& names,
                                                   std::ostream& to,
                                                   std::int64_t hertz = kDefaultHertz);
  // Removes the temporary file if close() was not called.
  ~VcdRecorder();

  // Ends the recording: writes pending changes and the end time. Error: a write failed, for example because
  // the disk is full.
  Result<void> close();

  class Impl;

 private:
  explicit VcdRecorder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kaz::h8s
