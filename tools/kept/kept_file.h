// Notes of a run that changes the state of a board. The notes contain the board's previous state.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/robot/kept_board.h"
#include "shared/base/result.hpp"

namespace kaz::tools {

struct KeptFile {
  std::string verb, port;  // for example "kaz conformance" and "/dev/ttyUSB0"
  // Path of the port, in which all symbolic links except the last one are resolved. Empty in notes of version
  // 0.1.0.
  std::string line;
  // Process id of the run, and start of the process in clock ticks since boot. Both are 0 in notes of version
  // 0.1.0.
  std::int64_t process = 0;
  std::uint64_t process_began = 0;
  std::vector<std::uint8_t> others;  // addresses of other boards on the line
  host::BoardState board;
};

// Notes of a running `kaz flash write`. `run.board` is unknown.
struct WriteFile {
  KeptFile run;
  std::string command, folder;  // command line of the write, and its working directory
};
std::string write_text(const WriteFile& write);
Result<WriteFile> parse_write(const std::string& text, const std::string& name);
// Fails (usage) if the file cannot be read or is not valid.
Result<WriteFile> read_write(const std::string& path);

// Convert notes to JSON and back. Error messages (usage) contain `name`.
std::string kept_text(const KeptFile& kept);
Result<KeptFile> parse_kept(const std::string& text, const std::string& name);
// Reads notes from a file. Fails (usage) if the file cannot be read or is not valid.
Result<KeptFile> read_kept(const std::string& path);

}  // namespace kaz::tools
