// Notes of a running `kaz flash write`. If it is killed, they contain the command that completes it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/kept/kept_run.h"

namespace kaz::tools {

class WriteNotes {
 public:
  // Writes the command line of this process. Fails (environment) if that is not possible.
  static Result<WriteNotes> begin(const std::string& port,
                                  const std::string& folder = kept_folder());

  // Removes these notes: the board was not changed.
  void drop() const;
  // Removes these notes, and those of earlier writes on the port: the board's flash is complete.
  void done() const;

 private:
  WriteNotes(std::string port, std::string folder, std::string path);
  std::string port_, folder_, path_;
};

// Returns a sentence with the completing command for each interrupted write on the port. Excludes writes that
// still run.
std::vector<std::string> interrupted_writes(const std::string& port,
                                            const std::string& folder = kept_folder());

}  // namespace kaz::tools
