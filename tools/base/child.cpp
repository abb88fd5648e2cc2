// A program of its own beside this one.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/child.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

namespace kaz::tools {

Result<Child> Child::begin(const std::vector<std::string>& arguments, const std::string& log) {
  return begin("/proc/self/exe", arguments, log);
}

Result<Child> Child::begin(const std::string& program, const std::vector<std::string>& arguments,
                           const std::string& log, Lifetime lifetime, int input) {
  const auto wrong = [&](const std::string& what) {
    return fail(Fault::environment, what + ": " + std::strerror(errno));
  };
  const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (out < 0) return wrong("'" + log + "' cannot be written");
  const bool own = program.starts_with("/proc/self/");
  std::vector<char*> argv{const_cast<char*>(own ? "kaz" : program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid == 0) {
    // Only what a child may do between fork and exec.
    ::setpgid(0, 0);  // Ctrl-C is the parent's
    if (lifetime == Lifetime::of_parent) ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(127);
    for (const int number : {SIGINT, SIGTERM}) ::signal(number, SIG_DFL);
    ::dup2(input >= 0 ? input : ::open("/dev/null", O_RDONLY), STDIN_FILENO);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
    ::execvp(program.c_str(), argv.data());
    ::_exit(127);
  }
  ::close(out);
  if (pid < 0) return wrong("cannot start " + (own ? "kaz " + arguments.front() : program));
  return Child(pid, lifetime);
}

Child::~Child() {
  if (pid_ < 0 || lifetime_ == Lifetime::own || ended()) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

std::optional<int> Child::ended() {
  int status = 0;
  if (!status_ && ::waitpid(pid_, &status, WNOHANG) == pid_)
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return status_;
}

std::optional<int> Child::wait(std::chrono::seconds at_most) {
  const auto until = std::chrono::steady_clock::now() + at_most;
  while (!ended() && std::chrono::steady_clock::now() < until) ::usleep(50'000);
  return status_;
}

void Child::signal(int number) {
  if (!ended()) ::kill(pid_, number);
}

}  // namespace kaz::tools
