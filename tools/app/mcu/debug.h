// What `kaz mcu run` can look at while it runs: trace, profile, coverage, stack, fresh RAM, GDB.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "shared/base/result.hpp"
#include "sim/h8s/chip/chip.h"

namespace kaz::tools {

// Files: "-" is standard error; empty: not wanted.
struct McuDebugOptions {
  std::string trace;
  std::string profile;
  std::string profile_format = "text";  // text, json, callgrind
  std::string tick;                     // "BEGIN,END": two symbols or addresses (0x...)
  std::string coverage;                 // lcov's format
  bool check_uninitialised = false;
  bool stack = false;
  std::string gdb;  // port, path or "-"
};

class McuDebug {
 public:
  // Attaches what is wanted; before power_on, so that fresh RAM is known. Errors: a symbol or a
  // file that cannot be had.
  static Result<std::unique_ptr<McuDebug>> attach(h8s::Chip& chip, const h8s::SymbolTable& symbols,
                                                  const McuDebugOptions& options);
  ~McuDebug();
  McuDebug(const McuDebug&) = delete;
  McuDebug& operator=(const McuDebug&) = delete;

  // Detaches and writes the reports. Errors: a file cannot be written.
  Result<void> report();

 private:
  struct Parts;
  explicit McuDebug(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

// Serves one GDB; what it does to the chip is all that happens. Returns too when `stop` is readable.
Result<bool> serve_gdb(h8s::Chip& chip, const std::string& where, int stop);

}  // namespace kaz::tools
