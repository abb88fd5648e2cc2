// Runs programs as a user would: separate processes, their exit status, what they print.
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/command_line/process_testing.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace kaz::test {

using Steady = std::chrono::steady_clock;

namespace {

// Notes of boards that a user, or another test, keeps are neither read nor written by this one.
void keep_state_apart() {
  static const TemporaryFolder folder;
  static const int set = setenv("XDG_STATE_HOME", folder.path().c_str(), 0);
  (void)set;
}

}  // namespace

Process::Process(const std::vector<std::string>& arguments, bool typing) {
  keep_state_apart();
  int in[2] = {-1, -1}, out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0 ||
      (typing && pipe2(in, O_CLOEXEC) != 0))
    throw std::runtime_error("pipe2");
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("fork");
  if (pid_ == 0) {
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    dup2(typing ? in[0] : open("/dev/null", O_RDONLY), STDIN_FILENO);
    std::vector<char*> argv;
    for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    execv(argv[0], argv.data());
    _exit(127);
  }
  if (typing) close(in[0]);
  in_ = in[1];
  close(out[1]);
  close(err[1]);
  out_ = out[0];
  err_ = err[0];
  fcntl(out_, F_SETFL, O_NONBLOCK);
  fcntl(err_, F_SETFL, O_NONBLOCK);
}

Process::~Process() {
  if (!ended_) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  if (in_ >= 0) close(in_);
  close(out_);
  close(err_);
}

void Process::type(const std::string& text) {
  if (write(in_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
    throw std::runtime_error("the program does not read its standard input");
}

void Process::signal(int number) {
  if (!ended_) kill(pid_, number);
}

double Process::cpu_s() const {
  // proc(5): fields 14 and 15, behind the name in parentheses.
  const std::string stat = read_file("/proc/" + std::to_string(pid_) + "/stat");
  std::istringstream fields(stat.substr(std::min(stat.rfind(')'), stat.size() - 1) + 1));
  std::string skipped;
  for (int i = 3; i < 14; ++i) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

void Process::drain(int milliseconds) {
  std::array<pollfd, 2> fds{pollfd{out_, POLLIN, 0}, pollfd{err_, POLLIN, 0}};
  poll(fds.data(), fds.size(), milliseconds);
  std::array<char, 4096> buffer{};
  ssize_t count = 0;
  while ((count = read(out_, buffer.data(), buffer.size())) > 0) {
    result_.out.append(buffer.data(), static_cast<std::size_t>(count));
  }
  while ((count = read(err_, buffer.data(), buffer.size())) > 0) {
    result_.err.append(buffer.data(), static_cast<std::size_t>(count));
  }
  int status = 0;
  rusage used{};
  if (!ended_ && wait4(pid_, &status, WNOHANG, &used) == pid_) {
    ended_ = true;
    for (const timeval& part : {used.ru_utime, used.ru_stime})
      result_.cpu_s += static_cast<double>(part.tv_sec) + 1e-6 * static_cast<double>(part.tv_usec);
    result_.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
}

bool Process::wait_for_output(const std::string& text, std::chrono::seconds at_most) {
  return prints_within(text, kBusy * at_most);
}

bool Process::prints_within(const std::string& text, std::chrono::seconds time) {
  const auto until = Steady::now() + time;
  const auto seen = [&] {
    return result_.out.find(text) != std::string::npos ||
           result_.err.find(text) != std::string::npos;
  };
  while (!seen() && !ended_ && Steady::now() < until) drain(20);
  drain(0);
  return seen();
}

Finished Process::wait(std::chrono::seconds at_most) {
  const auto until = Steady::now() + kBusy * at_most;
  while (!ended_ && Steady::now() < until) drain(20);
  if (!ended_) {
    kill(pid_, SIGKILL);
    while (!ended_) drain(20);
  }
  drain(0);
  return result_;
}

std::vector<std::string> kaz(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KAZ_PROGRAM);
  return arguments;
}

Finished run(const std::vector<std::string>& arguments, std::chrono::seconds at_most) {
  return Process(arguments).wait(at_most);
}

std::vector<std::vector<std::string>> all_verbs() {
  const std::string script = run(kaz({"completion", "bash"})).out;
  const std::regex one("'kaz([a-z -]*)'\\) words=");
  std::vector<std::vector<std::string>> verbs;
  for (std::sregex_iterator at(script.begin(), script.end(), one), end; at != end; ++at) {
    std::istringstream words((*at)[1].str());
    verbs.emplace_back(std::istream_iterator<std::string>(words),
                       std::istream_iterator<std::string>());
  }
  return verbs;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "kaz-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

void write_file(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

}  // namespace kaz::test
