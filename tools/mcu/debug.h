// Observers for `kaz mcu run`: trace, profile, coverage, stack, uninitialized reads, GDB.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "shared/base/result.hpp"
#include "sim/h8s/chip/chip.h"

namespace kaz::tools {

// Reports to write, by path. "-" means standard error. An empty path means that the report is not written.
struct McuDebugOptions {
  std::string trace;
  std::string profile;
  std::string profile_format = "text";  // text, json, callgrind
  // "BEGIN,END": symbols or addresses (0x...) at which the tick begins and ends.
  std::string tick;
  std::string coverage;  // path of a file in the format of lcov
  bool check_uninitialised = false;
  bool stack = false;
  // Where GDB connects: TCP port, path of a socket, or "-" for standard input and output.
  std::string gdb;
};

class McuDebug {
 public:
  // Attaches the requested observers. Call attach() before h8s::Chip::power_on(), so that reads of
  // uninitialized RAM are detected. Fails if a symbol is unknown or a file cannot be written. `chip` must
  // outlive the object.
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

// Serves one GDB client. Only the client makes the chip run. Returns when the client has left, or when the
// descriptor `stop` becomes readable.
Result<bool> serve_gdb(h8s::Chip& chip, const std::string& where, int stop);

}  // namespace kaz::tools
