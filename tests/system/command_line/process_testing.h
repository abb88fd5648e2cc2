// For tests: runs programs as a user does, and returns their exit status and output.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace kaz::test {

struct Finished {
  int exit_code = -1;  // 128 + signal if it was killed
  double cpu_s = 0;    // CPU time, with that of children that it has waited for
  std::string out, err;
};

// A running program. The destructor kills it.
class Process {
 public:
  // Starts a program. Its standard input is empty, or with `typing` the text of type().
  explicit Process(const std::vector<std::string>& arguments, bool typing = false);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number);
  pid_t id() const { return pid_; }
  // Returns the CPU time of all its threads so far.
  double cpu_s() const;
  // Writes to its standard input, a pipe that stays open during the object's lifetime.
  void type(const std::string& text);
  // Waits until standard output or standard error contains `text`. Returns false if the program ends first or
  // hangs. `at_most` is sufficient on an idle machine; the timeout is kBusy times that, for a busy one.
  bool wait_for_output(const std::string& text, std::chrono::seconds at_most);
  // The same with a timeout of exactly `time`.
  bool prints_within(const std::string& text, std::chrono::seconds time);
  // Waits for the end. Kills a process that hangs; its exit code is 137. `at_most` as above.
  Finished wait(std::chrono::seconds at_most);
  static constexpr int kBusy = 20;

 private:
  void drain(int milliseconds);
  pid_t pid_ = -1;
  int in_ = -1, out_ = -1, err_ = -1;
  bool ended_ = false;
  Finished result_;
};

// Returns the command line of this build's `kaz` with these arguments.
std::vector<std::string> kaz(std::vector<std::string> arguments);
// Runs a program to its end, as Process::wait().
Finished run(const std::vector<std::string>& arguments,
             std::chrono::seconds at_most = std::chrono::seconds(60));

// Returns every verb, also nested ones as {"mcu", "run"}. The completion script has a case for each.
std::vector<std::vector<std::string>> all_verbs();

// A new empty folder. The destructor removes it with its contents.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& content);

}  // namespace kaz::test
