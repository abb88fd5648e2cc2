// `kaz doctor`: finds problems of this machine that affect a real robot, and commands that fix them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"
#include "tools/doctor/machine_files.h"

namespace kaz::tools {

struct Finding {
  enum class Level {
    good,   // works without problems
    note,   // works but could be improved, or is absent
    wrong,  // does not work until the problem is fixed
  };
  Level level = Level::good;
  // Examined part: "serial", "can", "camera", "kernel", "toolchain", "cores", "board".
  std::string part;
  std::string subject;  // examined device or file, for example "/dev/ttyUSB0"
  std::string text;     // one sentence about the subject, without the subject itself
  // Command that fixes the problem, or several commands joined by &&; empty: no command.
  std::string remedy;
};

// Examines this machine without changing the machine. Opens video devices, but no serial port: opening the
// port of some adapters would reset a board.
std::vector<Finding> examine(const MachineFiles& files);

// Returns the finding about the board at `port`. `board`: reply of the board to the request identify.
Finding examine_board(const std::string& port, const Result<kz_identify_reply>& board);

struct DoctorOptions {
  bool json = false;
  std::string port;  // port of a board whose firmware is checked; empty: no board is checked
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
};
// Prints the findings. Returns false if a finding is `wrong`. Fails (usage) if the port is not valid.
Result<bool> run_doctor(const DoctorOptions& options);

}  // namespace kaz::tools
