// Folder for temporary files of an evaluation's episodes. The folder is removed even after an interrupt or an
// error. If an evaluation is killed, the next evaluation removes the folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>

#include "shared/base/result.hpp"

namespace kaz::tools {

// The folder is in TMPDIR or /tmp. The processes of the episodes use the folder as their TMPDIR. A killed
// process cannot remove its own files, so its parent process removes the files. A program that exits
// immediately (interrupt_signals.h) first kills the processes of the episodes and removes the folder. Only
// one object may exist in a process.
class WorkFolder {
 public:
  static constexpr const char* kPrefix = "kaz-evaluate-";
  static constexpr int kMaxUsers = 256;  // largest value of --jobs

  // Creates and locks the folder. Also removes the folders of this user's killed evaluations. These folders
  // are no longer locked. Fails (environment) if TMPDIR cannot be written to.
  static Result<WorkFolder> make();
  WorkFolder(WorkFolder&& other) noexcept
      : path_(std::exchange(other.path_, {})), folder_(std::exchange(other.folder_, -1)) {}
  WorkFolder& operator=(WorkFolder&&) = delete;
  // All processes that use the folder must have ended.
  ~WorkFolder();

  const std::string& path() const { return path_; }
  // Call add_user() when a child of this process starts to use the folder. Call remove_user() when the child
  // has ended.
  void add_user(pid_t child);
  void remove_user(pid_t child);

 private:
  WorkFolder(std::string path, int folder) : path_(std::move(path)), folder_(folder) {}
  std::string path_;
  int folder_;  // descriptor of the folder, which is open and locked
};

}  // namespace kaz::tools
