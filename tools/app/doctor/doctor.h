// `kaz doctor`: finds problems of this machine that affect a real robot, and the commands that fix them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"
#include "tools/app/doctor/machine_files.h"

namespace kaz::tools {

struct Finding {
  enum class Level {
    good,   // works
    note,   // works, or is absent, and could be improved
    wrong,  // does not work until it is fixed
  };
  Level level = Level::good;
  std::string part;     // "serial", "can", "camera", "kernel", "toolchain", "cores", "board"
  std::string subject;  // "/dev/ttyUSB0"
  std::string text;     // one sentence without the subject
  std::string remedy;   // a command, or several joined by &&; empty: none
};

// Examines this machine without changes. Opens video devices, but no serial port: some adapters would reset a
// board.
std::vector<Finding> examine(const MachineFiles& files);

// Returns the finding on the board at `port`, from its reply to identify.
Finding examine_board(const std::string& port, const Result<kz_identify_reply>& board);

struct DoctorOptions {
  bool json = false;
  std::string port;  // port of a board whose firmware to check; empty: none
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
};
// Prints the findings. Returns false if a finding is `wrong`. Fails (usage) if the port is not valid.
Result<bool> run_doctor(const DoctorOptions& options);

}  // namespace kaz::tools
