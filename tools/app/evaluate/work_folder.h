// Temporary files of an evaluation's episodes: removed however it ends, also by a second Ctrl-C.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>

#include "shared/base/result.hpp"

namespace kaz::tools {

// A folder in TMPDIR or /tmp, which the processes of the episodes get as their TMPDIR. An episode's process
// that is killed cannot remove its files, so its parent does. A program that ends at once
// (interrupt_signals.h) kills those processes and removes the folder first. One at a time in a process.
class WorkFolder {
 public:
  static constexpr const char* kPrefix = "kaz-evaluate-";
  static constexpr int kMaxUsers = 256;  // as many as --jobs may be

  // Also removes folders that killed evaluations of this user have left: an evaluation that runs holds a
  // lock on its folder. Errors (environment): TMPDIR cannot be written.
  static Result<WorkFolder> make();
  WorkFolder(WorkFolder&& other) noexcept
      : path_(std::exchange(other.path_, {})), folder_(std::exchange(other.folder_, -1)) {}
  WorkFolder& operator=(WorkFolder&&) = delete;
  // The processes that use it have ended before.
  ~WorkFolder();

  const std::string& path() const { return path_; }
  // A child of this process begins to use it, and has ended.
  void add_user(pid_t child);
  void remove_user(pid_t child);

 private:
  WorkFolder(std::string path, int folder) : path_(std::move(path)), folder_(folder) {}
  std::string path_;
  int folder_;  // open and locked
};

}  // namespace kaz::tools
