// Records pins, registers and memory to a VCD file (IEEE 1364), for GTKWave and others.
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

// Crystal of the boards that this emulator was made for; states per second.
inline constexpr std::int64_t kDefaultHertz = 18'432'000;

// Picoseconds since state 0, rounded to the nearest: a state is seldom a whole number of them.
std::int64_t picoseconds(States at, std::int64_t hertz);

// Names of signals:
//   a pin by any name ("P50", "TxD0"), or "pins" for all of them
//   er0..er7, sp, pc, ccr, exr, or "cpu" for all of them
//   an I/O register ("FRC", "SSR0"; registers.h)
//   memory by symbol or address, with its width in bits: "_tick:16", "0xffe100:8" (default 8)
//
// Pins change at their exact states: '0', '1', 'z' while nobody drives and no pull-up pulls, and 'x'
// for P46 while it puts out the clock itself. Everything else is sampled at each instruction
// boundary and written when it has changed; a register that shares its address with another keeps
// its last value while the other one is selected ('x' before). Nothing is rewritten: after a
// restore to an earlier state recording resumes when time passes the last entry.
class VcdRecorder {
 public:
  // Records from now until close() to a temporary file beside `path`, which is renamed to `path` at the
  // end. `chip` must outlive this and must not be moved. `hertz`: states per second. Errors: an unknown
  // name, a write-only register, a file that cannot be created.
  static Result<std::unique_ptr<VcdRecorder>> open(Chip& chip,
                                                   const std::vector<std::string>& names,
                                                   const std::string& path,
                                                   std::int64_t hertz = kDefaultHertz);
  // Records to a stream, which must outlive this.
  static Result<std::unique_ptr<VcdRecorder>> open(Chip& chip,
                                                   const std::vector<std::string>& names,
                                                   std::ostream& to,
                                                   std::int64_t hertz = kDefaultHertz);
  // Removes a file that has not been closed.
  ~VcdRecorder();

  // Writes pending changes and the end time. Errors: any write failed (disk full).
  Result<void> close();

  class Impl;

 private:
  explicit VcdRecorder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kaz::h8s
