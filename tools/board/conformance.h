// `kaz conformance`: checks with test cases whether a board implements the protocol.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/conformance/report.h"
#include "shared/base/result.hpp"
#include "shared/servo_bus/registers.h"
#include "sim/mcu/mcu_kind.h"
#include "tools/base/exit_status.h"

namespace kaz::tools {

struct ConformanceOptions {
  std::string port;  // port of the board; empty: a virtual board
  // Kind of the virtual board; nullopt: the board is at a port.
  std::optional<sim::McuKind> mcu;
  std::string image;  // firmware image for h8; empty: the installed image
  // Paths of reports; "-": standard output; empty: no report.
  std::string junit, json, html;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // address of the board at the port
  bool list = false, allow_motion = false, allow_flash = false;
  hil::RunOptions run;
  // Protocol of the bus if a servo is tested; nullopt: a board is tested.
  std::optional<servo_bus::Protocol> bus;
  int id = 1;
  long baud = 0;  // baud rate of the bus; 0: the servos' factory setting
  bool allow_eeprom = false, alone = false, release = false;
};

// Runs the test cases and writes the reports. With `list`, lists the cases, and runs no case. Exit status
// 1: a case failed. Exit status 3: no case failed, but this machine was too late to judge some cases.
Result<ExitStatus> run_conformance(ConformanceOptions arguments);

}  // namespace kaz::tools
