// `kaz doctor`: what of this machine would keep a real robot from working, and the command that mends it.
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
    note,   // works, or is not there, and could be better
    wrong,  // does not work until it is mended
  };
  Level level = Level::good;
  std::string part;     // "serial", "can", "camera", "kernel", "toolchain", "cores", "board"
  std::string subject;  // "/dev/ttyUSB0"
  std::string text;     // one sentence without the subject
  std::string remedy;   // a command, or several joined by &&; empty if there is none
};

// Reads only; opens video devices, and no serial port: a board would be reset by some adapters.
std::vector<Finding> examine(const MachineFiles& files);

// About the board at `port`, as it has identified itself.
Finding examine_board(const std::string& port, const Result<kz_identify_reply>& board);

struct DoctorOptions {
  bool json = false;
  std::string port;  // of a board to be asked for its firmware; empty: none
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
};
// Prints the findings. False: something is wrong. Errors: usage, of the port's name.
Result<bool> run_doctor(const DoctorOptions& options);

}  // namespace kaz::tools
