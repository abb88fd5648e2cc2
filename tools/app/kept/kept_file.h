// The notes of a run that alters a board: what the board was like before.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/robot/kept_board.h"
#include "shared/base/result.hpp"

namespace kaz::tools {

struct KeptFile {
  std::string verb, port;  // "kaz conformance", "/dev/ttyUSB0"
  // Of the port, with symbolic links but the last followed; empty in notes of version 0.1.0.
  std::string line;
  std::int64_t process = 0;  // of the run, and when it began, in ticks since the machine did;
  std::uint64_t process_began = 0;   // 0 in notes of version 0.1.0
  std::vector<std::uint8_t> others;  // addresses of other boards on the line
  host::BoardState board;
};

// The notes of a `kaz flash write` that is under way. Of `run` the board is not known.
struct WriteFile {
  KeptFile run;
  std::string command, folder;  // what was given, and where
};
std::string write_text(const WriteFile& write);
Result<WriteFile> parse_write(const std::string& text, const std::string& name);
// Errors (usage): why it cannot be read, too.
Result<WriteFile> read_write(const std::string& path);

// As JSON, and back. Errors (usage) name the file.
std::string kept_text(const KeptFile& kept);
Result<KeptFile> parse_kept(const std::string& text, const std::string& name);
// Those of a file. Errors (usage): why it cannot be read, too.
Result<KeptFile> read_kept(const std::string& path);

}  // namespace kaz::tools
