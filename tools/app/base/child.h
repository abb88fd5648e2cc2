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

// Runs in a process group of its own, so that Ctrl-C in the terminal does not reach it. Standard output and
// standard error go to a log file.
class Child {
 public:
  // of_parent: killed by the destructor of Child, and when the parent process ends for any reason.
  // own: runs on after both.
  enum class Lifetime { of_parent, own };
  // Starts this executable again with other arguments. `log` is replaced.
  static Result<Child> begin(const std::vector<std::string>& arguments, const std::string& log);
  // Starts a program, searched in PATH. If the program is missing, the child exits with status 127. `input`
  // becomes its standard input; the caller keeps ownership of the descriptor. With -1 standard input is
  // /dev/null.
  static Result<Child> begin(const std::string& program, const std::vector<std::string>& arguments,
                             const std::string& log, Lifetime lifetime = Lifetime::of_parent,
                             int input = -1);
  Child(Child&& other) noexcept
      : pid_(std::exchange(other.pid_, -1)), lifetime_(other.lifetime_), status_(other.status_) {}
  Child& operator=(Child&&) = delete;
  ~Child();

  // Returns its exit status, or 128 + signal if a signal ended it. Returns nullopt while it runs.
  std::optional<int> ended();
  // Waits up to `at_most` for its end. Returns as ended().
  std::optional<int> wait(std::chrono::seconds at_most);
  void signal(int number);

 private:
  Child(pid_t pid, Lifetime lifetime) : pid_(pid), lifetime_(lifetime) {}
  pid_t pid_;
  Lifetime lifetime_;
  std::optional<int> status_;
};

}  // namespace kaz::tools
