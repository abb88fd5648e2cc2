// Counting host instructions: perf_event_open where it is permitted, else callgrind on this program.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/shell_word.hpp"
#include "tools/benchmark/benchmark.h"

#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace kaz::bench {
namespace {

const Load* load_of(const std::string& name) {
  const auto found = std::find_if(loads().begin(), loads().end(),
                                  [&](const Load& load) { return load.name == name; });
  return found == loads().end() ? nullptr : &*found;
}

// The processor's counter of instructions in user mode.
class Counter {
 public:
  Counter() {
    perf_event_attr attributes{};
    attributes.type = PERF_TYPE_HARDWARE;
    attributes.size = sizeof attributes;
    attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
    attributes.exclude_kernel = 1;
    attributes.exclude_hv = 1;
    file_ = static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, 0));
  }
  ~Counter() {
    if (file_ >= 0) ::close(file_);
  }
  Counter(const Counter&) = delete;
  Counter& operator=(const Counter&) = delete;
  bool works() const { return file_ >= 0; }
  std::optional<double> read() const {
    std::int64_t value = 0;
    if (::read(file_, &value, sizeof value) != sizeof value) return std::nullopt;
    return static_cast<double>(value);
  }

 private:
  int file_ = -1;
};

std::optional<double> by_counter(const Counter& counter, const Load& load,
                                 const std::string& engine, int amount) {
  const auto before = counter.read();
  if (!load.run(engine, amount)) return std::nullopt;
  const auto after = counter.read();
  if (!before || !after) return std::nullopt;
  return *after - *before;
}

std::optional<double> by_callgrind(const std::string& load, const std::string& engine, int amount) {
  std::error_code error;
  const std::string self = std::filesystem::read_symlink("/proc/self/exe", error).string();
  if (error) return std::nullopt;
  const std::string command =
      "valgrind --tool=callgrind --smc-check=all --callgrind-out-file=/dev/null " +
      shell_word(self) + " --run " + load + " --amount " + std::to_string(amount) + " --engine " + engine +
      " 2>&1 >/dev/null";
  std::FILE* output = ::popen(command.c_str(), "r");
  if (!output) return std::nullopt;
  std::optional<double> collected;
  char line[512];
  while (std::fgets(line, sizeof line, output)) {
    double value = 0;
    const char* at = std::string_view(line).find("Collected : ") == std::string_view::npos
                         ? nullptr
                         : line + std::string_view(line).find("Collected : ");
    if (at && std::sscanf(at, "Collected : %lf", &value) == 1) collected = value;
  }
  return ::pclose(output) == 0 ? collected : std::nullopt;
}

}  // namespace

std::optional<double> host_instructions(const std::string& name, const std::string& engine, int few,
                                        int many, Results& results) {
  const Load* load = load_of(name);
  if (!load) return std::nullopt;
  std::optional<double> less, more;
  if (const Counter counter; counter.works()) {
    less = by_counter(counter, *load, engine, few);
    more = by_counter(counter, *load, engine, many);
    results.remark("host instructions: counted by the processor");
  } else {
    less = by_callgrind(name, engine, few);
    more = less ? by_callgrind(name, engine, many) : std::nullopt;
    results.remark(more ? "host instructions: counted by valgrind's callgrind"
                        : "host instructions left out: the processor's counter is not readable "
                          "here, and valgrind is missing (apt-get install valgrind) or failed");
  }
  if (!less || !more) return std::nullopt;
  return *more - *less;
}

}  // namespace kaz::bench
