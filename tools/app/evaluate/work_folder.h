// Temporary files of an evaluation's episodes, which are removed however it ends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>

#include "shared/base/result.hpp"

namespace kaz::tools {

// The folder is in TMPDIR or /tmp. The processes of the episodes use it as their TMPDIR. A killed process
// cannot remove its files, so its parent removes them. A program that exits at once (interrupt_signals.h)
// first kills these processes and removes the folder. Only one object may exist in a process.
class WorkFolder {
 public:
  static constexpr const char* kPrefix = "kaz-evaluate-";
  static constexpr int kMaxUsers = 256;  // largest value of --jobs

  // Creates and locks the folder. Also removes folders of killed evaluations of this user, which hold no lock
  // any more. Fails (environment) if TMPDIR cannot be written to.
  static Result<WorkFolder> make();
  WorkFolder(WorkFolder&& other) noexcept
      : path_(std::exchange(other.path_, {})), folder_(std::exchange(other.folder_, -1)) {}
  WorkFolder& operator=(WorkFolder&&) = delete;
  // All processes that use the folder must have ended.
  ~WorkFolder();

  const std::string& path() const { return path_; }
  // Call these when a child of this process starts to use the folder, and when it has ended.
  void add_user(pid_t child);
  void remove_user(pid_t child);

 private:
  WorkFolder(std::string path, int folder) : path_(std::move(path)), folder_(folder) {}
  std::string path_;
  int folder_;  // open and locked
};

}  // namespace kaz::tools
