// Runs programs as a user would: separate processes, their exit status, what they print.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace kaz::test {

struct Finished {
  int exit_code = -1;  // 128 + signal if it was killed
  double cpu_s = 0;    // its processor time, and that of its children whose end it has waited for
  std::string out, err;
};

// A program under way; killed when the object goes.
class Process {
 public:
  // Its standard input is empty, or with `typing` what type() gives it.
  explicit Process(const std::vector<std::string>& arguments, bool typing = false);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number);
  pid_t id() const { return pid_; }
  // Processor time of all its threads so far.
  double cpu_s() const;
  // To its standard input, which is a pipe that stays open as long as the object does.
  void type(const std::string& text);
  // Waits until standard output or standard error holds `text`; false if it ended or hangs. `at_most` is
  // more than an idle machine needs; a busy one gets kBusy times as long.
  bool wait_for_output(const std::string& text, std::chrono::seconds at_most);
  // The same, but never longer than `time`.
  bool prints_within(const std::string& text, std::chrono::seconds time);
  // Waits for the end. A process that hangs is killed, and its exit code says so (137); `at_most` as above.
  Finished wait(std::chrono::seconds at_most);
  static constexpr int kBusy = 20;

 private:
  void drain(int milliseconds);
  pid_t pid_ = -1;
  int in_ = -1, out_ = -1, err_ = -1;
  bool ended_ = false;
  Finished result_;
};

// The `kaz` program of this build with these arguments.
std::vector<std::string> kaz(std::vector<std::string> arguments);
Finished run(const std::vector<std::string>& arguments,
             std::chrono::seconds at_most = std::chrono::seconds(60));

// Every verb and verb of a verb: {"mcu", "run"}. The completion script has a case for each.
std::vector<std::vector<std::string>> all_verbs();

// A new empty folder, removed with everything in it when the object goes.
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
