// Notes of a `kaz flash write` under way: if it is killed, they name the command that completes it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/kept/kept_run.h"

namespace kaz::tools {

class WriteNotes {
 public:
  // Of this process's command line. Errors (environment): they cannot be written.
  static Result<WriteNotes> begin(const std::string& port,
                                  const std::string& folder = kept_folder());

  // The board was not changed: removes these notes.
  void drop() const;
  // The board's flash is whole: removes these notes, and those of earlier writes on the port.
  void done() const;

 private:
  WriteNotes(std::string port, std::string folder, std::string path);
  std::string port_, folder_, path_;
};

// A sentence for each write on the port that has left such notes: the command that completes it. None of a
// write that is under way.
std::vector<std::string> interrupted_writes(const std::string& port,
                                            const std::string& folder = kept_folder());

}  // namespace kaz::tools
