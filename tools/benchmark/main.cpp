// `kaz_benchmark`: measures the speeds that the project promises (`./tools/dev benchmark`).
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <regex>

#include <CLI/CLI.hpp>

#include "tools/benchmark/benchmark.h"
#include "tools/benchmark/engines.h"

namespace {

using namespace kaz;
using namespace kaz::bench;

struct Arguments {
  std::string filter, json, run;
  int amount = 1000;
  bool list = false;
  Settings settings;
};

std::vector<Group> all_groups() {
  std::vector<Group> groups = emulator_groups();
  for (auto& group : firmware_groups()) groups.push_back(std::move(group));
  for (auto& group : program_groups()) groups.push_back(std::move(group));
  return groups;
}

void progress(const std::string& what, std::size_t done, std::size_t of) {
  if (::isatty(STDERR_FILENO) == 1) {
    std::fprintf(stderr, "\r\033[K[%zu/%zu] %s", done + 1, of, what.c_str());
    if (done == of) std::fprintf(stderr, "\r\033[K");
  } else if (done < of) {
    std::fprintf(stderr, "bench %zu/%zu: %s\n", done + 1, of, what.c_str());
  }
}

Result<void> measure(const Arguments& arguments) {
  std::regex filter;
  try {
    filter = std::regex(arguments.filter.empty() ? ".*" : arguments.filter);
  } catch (const std::regex_error&) {
    return fail(Fault::usage,
                "--filter " + arguments.filter + " is not a regular expression; see --help");
  }
  const auto wanted = [&](const std::string& name) { return std::regex_search(name, filter); };
  std::vector<Group> groups;
  for (auto& group : all_groups()) {
    if (std::any_of(group.gives.begin(), group.gives.end(), wanted))
      groups.push_back(std::move(group));
  }
  if (groups.empty())
    return fail(Fault::usage, "--filter " + arguments.filter + " matches no name; see --list");
  if (arguments.list) {
    for (const auto& group : groups)
      for (const auto& name : group.gives)
        if (wanted(name)) std::printf("%s\n", name.c_str());
    return {};
  }
  Results measured, results;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    progress(groups[k].gives.front(), k, groups.size());
    if (auto done = groups[k].run(arguments.settings, measured); !done)
      return fail(done.error().fault, groups[k].gives.front() + ": " + done.error().message);
    for (const auto& name : groups[k].gives) {
      if (!wanted(name)) continue;
      for (const auto& engine : arguments.settings.engines) {
        if (const auto value = measured.get(named(name, engine)))
          results.put(named(name, engine), *value);
      }
      if (const auto value = measured.get(name)) results.put(name, *value);
    }
  }
  for (const auto& remark : measured.remarks()) results.remark(remark);
  progress("", groups.size(), groups.size());
  std::printf("%s", table(results, arguments.settings.engines).c_str());
  if (arguments.json.empty()) return {};
  return write_json(arguments.json, results, arguments.settings.engines);
}

Result<void> run_load(const Arguments& arguments) {
  for (const Load& load : loads()) {
    if (load.name == arguments.run)
      return load.run(arguments.settings.engines.front(), arguments.amount);
  }
  std::string known;
  for (const Load& load : loads()) known += " " + std::string(load.name);
  return fail(Fault::usage, "--run " + arguments.run + ": give one of" + known);
}

int parse_and_run(int argc, char** argv) {
  CLI::App program(
      "Measures the speed of Kaz on one core: the emulator, the servo firmware in it, and the\n"
      "virtual robot. Times are CPU times of this process, medians of several runs.");
  program.name("kaz_benchmark");
  Arguments arguments;
  program.add_option("--filter", arguments.filter,
                     "measure only the numbers whose names match this regular expression");
  program.add_option("--json", arguments.json,
                     "also write each number, with its name, to this JSON file");
  auto known = engine_names();
  program
      .add_option("--engine", arguments.settings.engines,
                  "emulator engines to measure, separated by commas. If a number is measured with "
                  "an engine other than the default engine, the number's name ends with the "
                  "engine's name")
      ->delimiter(',')
      ->check(CLI::IsMember(known));
  program.add_option("--repeats", arguments.settings.repeats, "number of runs for each median")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  program.add_flag("--quick", arguments.settings.quick,
                   "make a short run that only checks the benchmark; the numbers are inaccurate");
  program.add_flag("--list", arguments.list, "print the names of the numbers, and measure nothing");
  program.add_option("--run", arguments.run,
                     "run one load of the emulator and print nothing, for use with a profiler");
  program
      .add_option(
          "--amount", arguments.amount,
          "with --run: length of the load, in rounds (mcu.mips.*) or in ms (mcu.firmware_x)")
      ->check(CLI::Range(1, 65535))
      ->capture_default_str();
  program.footer(
      "Examples:\n"
      "  ./tools/dev benchmark\n"
      "  ./tools/dev benchmark --filter mcu --json mcu.json\n"
      "  ./tools/dev benchmark --filter 'mips|firmware_x' --engine " +
      known.back() +
      "\n"
      "  valgrind --tool=callgrind build/release/bin/kaz_benchmark --run mcu.firmware_x --amount "
      "200\n"
      "The page docs/results/README.md explains each number and its measurement.\n"
      "Exit status: 0 measured, 1 a measurement failed, 2 wrong usage, 3 the environment failed.");
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return program.exit(success);
  } catch (const CLI::ParseError& wrong) {
    std::fprintf(stderr, "kaz_benchmark: %s; see `kaz_benchmark --help`\n", wrong.what());
    return static_cast<int>(Fault::usage);
  }
  if (arguments.settings.engines.empty()) arguments.settings.engines = {known.front()};
  if (arguments.settings.quick) arguments.settings.repeats = 1;
  const auto done = arguments.run.empty() ? measure(arguments) : run_load(arguments);
  if (done) return 0;
  std::fprintf(stderr, "kaz_benchmark: %s\n", done.error().message.c_str());
  return static_cast<int>(done.error().fault);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return parse_and_run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kaz_benchmark: %s\n", error.what());
    return static_cast<int>(Fault::environment);
  }
}
