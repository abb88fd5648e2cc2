// A child process.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

// The child runs in its own process group: Ctrl-C in the terminal sends no signal to the child. The child's
// standard output and standard error go to a log file.
class Child {
 public:
  // `of_parent`: the destructor of Child kills the child. The child is also killed if the parent process ends
  // for any reason. `own`: the child survives the destructor of Child and the end of the parent process.
  enum class Lifetime { of_parent, own };
  // Starts another process of this executable, with `arguments`. Replaces the file `log`.
  static Result<Child> begin(const std::vector<std::string>& arguments, const std::string& log);
  // Starts a program, searched in PATH. If the program is missing, the child exits with status 127. `input`
  // becomes the child's standard input. The caller keeps ownership of the descriptor. If `input` is -1, the
  // child's standard input is /dev/null.
  static Result<Child> begin(const std::string& program, const std::vector<std::string>& arguments,
                             const std::string& log, Lifetime lifetime = Lifetime::of_parent,
                             int input = -1);
  Child(Child&& other) noexcept
      : pid_(std::exchange(other.pid_, -1)), lifetime_(other.lifetime_), status_(other.status_) {}
  Child& operator=(Child&&) = delete;
  ~Child();

  // Returns the child's exit status, or 128 + signal number if a signal ended the child. Returns nullopt if
  // the child is still running.
  std::optional<int> ended();
  // Waits up to `at_most` for the end of the child. Returns the same values as ended().
  std::optional<int> wait(std::chrono::seconds at_most);
  void signal(int number);

 private:
  Child(pid_t pid, Lifetime lifetime) : pid_(pid), lifetime_(lifetime) {}
  pid_t pid_;
  Lifetime lifetime_;
  std::optional<int> status_;
};

}  // namespace kaz::tools
