// Notes of a running `kaz flash write`, for the case that the process is killed.
// SPDX-License-Identifier: Apache-2.0
// The notes contain the command that completes the write.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/kept/kept_run.h"

namespace kaz::tools {

class WriteNotes {
 public:
  // Writes notes with the command line of this process. Fails (environment) if the notes cannot be written.
  static Result<WriteNotes> begin(const std::string& port,
                                  const std::string& folder = kept_folder());

  // Removes these notes. Call drop() if the board was not changed.
  void drop() const;
  // Removes these notes and the notes of earlier writes on the port. Call done() if the board's flash is
  // complete.
  void done() const;

 private:
  WriteNotes(std::string port, std::string folder, std::string path);
  std::string port_, folder_, path_;
};

// Returns one sentence per interrupted write on the port, with the command that completes the write. Excludes
// writes that are still running.
std::vector<std::string> interrupted_writes(const std::string& port,
                                            const std::string& folder = kept_folder());

}  // namespace kaz::tools
