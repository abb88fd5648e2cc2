// Observers for `kaz mcu run`: trace, profile, coverage, stack, uninitialized reads, GDB.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "shared/base/result.hpp"
#include "sim/h8s/chip/chip.h"

namespace kaz::tools {

// File names: "-" is standard error, empty is off.
struct McuDebugOptions {
  std::string trace;
  std::string profile;
  std::string profile_format = "text";  // text, json, callgrind
  std::string tick;                     // "BEGIN,END": two symbols or addresses (0x...)
  std::string coverage;                 // in the format of lcov
  bool check_uninitialised = false;
  bool stack = false;
  std::string gdb;  // port, path or "-"
};

class McuDebug {
 public:
  // Attaches the requested observers. Call it before power_on, so that it detects reads of uninitialized RAM.
  // Fails if a symbol is unknown or a file cannot be written. `chip` must outlive the object.
  static Result<std::unique_ptr<McuDebug>> attach(h8s::Chip& chip, const h8s::SymbolTable& symbols,
                                                  const McuDebugOptions& options);
  ~McuDebug();
  McuDebug(const McuDebug&) = delete;
  McuDebug& operator=(const McuDebug&) = delete;

  // Detaches the observers and writes the reports. Fails if a file cannot be written.
  Result<void> report();

 private:
  struct Parts;
  explicit McuDebug(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

// Serves one GDB client, which alone controls the chip. Also returns when the descriptor `stop` is readable.
Result<bool> serve_gdb(h8s::Chip& chip, const std::string& where, int stop);

}  // namespace kaz::tools
