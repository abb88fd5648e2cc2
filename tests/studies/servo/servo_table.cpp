// servo_table: fits each friction model to drawn servos that are richer than any, and prints how well logs
// are predicted that no fit has seen; or writes the logs of one.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>

#include <CLI/CLI.hpp>

#include "hil/servo/servo_fit.h"
#include "hil/servo/truth_log_testing.h"
#include "shared/base/files.hpp"

namespace {

using namespace kaz;
using hil::truth::Motion;

struct Logs {
  std::vector<hil::ServoLog> fit, held_out;
};

// Two masses, four motions, and three gains, of which the middle one is held out.
Logs logs_of(std::uint64_t seed) {
  Logs logs;
  for (const Motion motion :
       {Motion::sine_of_square, Motion::lift_and_drop, Motion::up_and_down, Motion::two_sines}) {
    for (const double mass : {0.5, 1.0}) {
      for (const double gain : {1.0, 0.25})
        logs.fit.push_back(hil::log_of(hil::truth::swing(seed, motion, mass, gain)));
      logs.held_out.push_back(hil::log_of(hil::truth::swing(seed, motion, mass, 0.5)));
    }
  }
  return logs;
}

bool write_logs(const Logs& logs, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  int number = 0;
  for (const auto* part : {&logs.fit, &logs.held_out}) {
    number = 0;
    for (const hil::ServoLog& log : *part) {
      const std::string path =
          folder + (part == &logs.fit ? "/fit-" : "/held-") + std::to_string(++number) + ".csv";
      if (const auto written = write_whole_file(path, hil::servo_log_text(log)); !written) {
        std::fprintf(stderr, "servo_table: %s\n", written.error().message.c_str());
        return false;
      }
    }
  }
  return true;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

}  // namespace

int main(int count, char** words) {
  CLI::App app("Fits of servos that are richer than the models.");
  std::uint64_t first = 1, motors = 20;
  std::string write;
  app.add_option("--first", first, "seed of the first")->capture_default_str();
  app.add_option("--motors", motors, "how many")->capture_default_str();
  app.add_option("--write", write, "only write the first one's logs into this folder");
  CLI11_PARSE(app, count, words);
  if (!write.empty()) return write_logs(logs_of(first), write) ? 0 : 3;

  std::printf(
      "| motor | M1 | M2 | M3 | M4 | M5 | M6 | M6 / M1 | current of M6, %% | not determined of M6 "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  std::vector<double> ratios, currents;
  std::map<std::string, int> open;
  for (std::uint64_t seed = first; seed < first + motors; ++seed) {
    const Logs logs = logs_of(seed);
    const auto fits = hil::fit_servo(logs.fit, logs.held_out);
    if (!fits) {
      std::fprintf(stderr, "servo_table: motor %llu: %s\n", static_cast<unsigned long long>(seed),
                   fits.error().message.c_str());
      return 1;
    }
    std::printf("| %llu |", static_cast<unsigned long long>(seed));
    for (const hil::ServoFit& fit : *fits) std::printf(" %.2f |", 1e3 * fit.held_out.position_rad);
    const hil::ServoFit& last = fits->back();
    ratios.push_back(last.held_out.position_rad / fits->front().held_out.position_rad);
    currents.push_back(100 * last.held_out.current_share);
    std::string names;
    for (const hil::FittedServoParam& one : last.fitted) {
      if (one.determined) continue;
      names += (names.empty() ? "" : ", ") + std::string(one.of->name);
      ++open[std::string(one.of->name)];
    }
    std::printf(" %.2f | %.1f | %s |\n", ratios.back(), currents.back(), names.c_str());
    std::fflush(stdout);
  }
  std::printf(
      "\nmean error of the position, mrad, of logs held out; M6 / M1: median %.2f, largest %.2f; "
      "current: "
      "median %.1f %%, largest %.1f %%\n",
      median(ratios), *std::ranges::max_element(ratios), median(currents),
      *std::ranges::max_element(currents));
  for (const auto& [name, times] : open)
    std::printf("%s: not determined in %d of %llu\n", name.c_str(), times,
                static_cast<unsigned long long>(motors));
  return 0;
}
