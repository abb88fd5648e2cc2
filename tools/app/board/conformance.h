// `kaz conformance`: certifies the protocol of a board, case by case.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/conformance/report.h"
#include "shared/base/result.hpp"
#include "shared/servo_bus/registers.h"
#include "sim/mcu/mcu_kind.h"
#include "tools/app/base/outcome.h"

namespace kaz::tools {

struct ConformanceOptions {
  std::string port;                           // port of a board; empty: a virtual one
  std::optional<sim::McuKind> mcu;            // for the virtual board; nullopt: a board at a port
  std::string image;                          // firmware image for h8; empty: the installed one
  std::string junit, json, html;              // report files; "-": standard output; empty: none
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // address at the port
  bool list = false, allow_motion = false, allow_flash = false;
  hil::RunOptions run;
  // Tests a servo on a bus instead of a board; nullopt: a board.
  std::optional<servo_bus::Protocol> bus;
  int id = 1;
  long baud = 0;  // baud rate of the bus; 0: the servos' factory setting
  bool allow_eeprom = false, alone = false, release = false;
};

// Runs the cases and writes the reports, or lists the cases. Status 1: a case failed. Status 3: no case
// failed, but this machine was too late to judge some.
Result<Outcome> run_conformance(ConformanceOptions arguments);

}  // namespace kaz::tools
