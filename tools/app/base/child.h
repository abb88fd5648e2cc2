// A program of its own beside this one.
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

// In a process group of its own: a Ctrl-C in the terminal does not reach it.
class Child {
 public:
  // of_parent: it ends when its object goes, and when the process that began it is gone, however that ended.
  // own: it ends by itself, also without that process.
  enum class Lifetime { of_parent, own };
  // This very program with other arguments; what it prints goes into the file `log`.
  static Result<Child> begin(const std::vector<std::string>& arguments, const std::string& log);
  // Starts a program of PATH. If there is none, its exit status is 127. `input` is a descriptor for its
  // standard input, and stays the caller's. With -1 its standard input is empty.
  static Result<Child> begin(const std::string& program, const std::vector<std::string>& arguments,
                             const std::string& log, Lifetime lifetime = Lifetime::of_parent,
                             int input = -1);
  Child(Child&& other) noexcept
      : pid_(std::exchange(other.pid_, -1)), lifetime_(other.lifetime_), status_(other.status_) {}
  Child& operator=(Child&&) = delete;
  ~Child();

  // Its exit status, 128 + signal if one ended it; nothing while it runs.
  std::optional<int> ended();
  std::optional<int> wait(std::chrono::seconds at_most);
  void signal(int number);

 private:
  Child(pid_t pid, Lifetime lifetime) : pid_(pid), lifetime_(lifetime) {}
  pid_t pid_;
  Lifetime lifetime_;
  std::optional<int> status_;
};

}  // namespace kaz::tools
