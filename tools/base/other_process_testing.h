// A second process that holds the lock of a file or folder, for tests of locks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace kaz::tools {

// The constructor forks a process that calls take() and keeps the returned object, such as a lock. The
// destructor kills the process.
class OtherProcess {
 public:
  template <class Take>
  explicit OtherProcess(Take take) {
    int ready[2] = {-1, -1};
    if (::pipe(ready) != 0) return;
    process_ = ::fork();
    if (process_ == 0) {
      const auto held = take();
      const char byte = held ? 'y' : 'n';
      (void)!::write(ready[1], &byte, 1);
      for (;;) ::pause();
    }
    ::close(ready[1]);
    char byte = 'n';
    holds_ = ::read(ready[0], &byte, 1) == 1 && byte == 'y';
    ::close(ready[0]);
  }
  ~OtherProcess() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  OtherProcess(const OtherProcess&) = delete;
  OtherProcess& operator=(const OtherProcess&) = delete;

  bool holds() const { return holds_; }
  pid_t process() const { return process_; }

 private:
  pid_t process_ = -1;
  bool holds_ = false;
};

}  // namespace kaz::tools
