// Date, version, machine and command line of this run of the program, for its reports.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/provenance.h"

#include <sys/utsname.h>

#include <ctime>
#include <fstream>
#include <string>
#include <thread>

#include <nlohmann/json.hpp>

#include "shared/base/shell_word.hpp"
#include "tools/base/version.h"

namespace kaz::tools {
namespace {

std::vector<std::string>& words() {
  static std::vector<std::string> of_command;
  return of_command;
}

// The text behind the first `key` and its separator; "" if there is none.
std::string value_in(const char* path, const std::string& key, char separator) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const auto at = line.find(separator);
    if (at == std::string::npos) continue;
    const auto first = line.find_first_not_of(" \t\"", at + 1);
    if (first == std::string::npos) continue;
    const auto last = line.find_last_not_of(" \t\"");
    return line.substr(first, last - first + 1);
  }
  return "";
}

std::string cpu_model(const utsname& system) {
  for (const char* key : {"model name", "Model", "Hardware"}) {  // the latter two on ARM
    const std::string model = value_in("/proc/cpuinfo", key, ':');
    if (!model.empty()) return model;
  }
  return system.machine;
}

}  // namespace

void set_command_line(int argc, const char* const* argv) {
  words().assign(argv + (argc > 0 ? 1 : 0), argv + argc);
}

const std::vector<std::string>& command_words() {
  return words();
}

hil::Provenance provenance() {
  hil::Provenance from;
  char date[32];
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
  from.date = date;
  from.kaz = kVersion;
  utsname system{};
  uname(&system);
  from.cpu = cpu_model(system);
  from.cores = static_cast<int>(std::thread::hardware_concurrency());
  from.os = std::string(system.sysname) + " " + system.release + " " + system.machine;
  const std::string name = value_in("/etc/os-release", "PRETTY_NAME", '=');
  if (!name.empty()) from.os = name + ", " + from.os;
  from.command = "kaz";
  for (const std::string& word : words()) from.command += " " + shell_word(word);
  return from;
}

nlohmann::ordered_json provenance_json() {
  return hil::provenance_json(provenance());
}

}  // namespace kaz::tools
