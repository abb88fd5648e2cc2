// Clocks of the process, and the table of its parts.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_profile.h"

#include <time.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <thread>

namespace kaz::tools {
namespace {

double seconds_of(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// CPU time of threads that belong to libraries, and of ours between scopes.
double other_cpu_s(const RunProfile& profile) {
  double sum = 0;
  for (const auto& part : profile.parts) sum += part.cpu_s;
  return std::max(0.0, profile.cpu_s - sum);
}

double share(double a, double b) {
  return b > 0 ? a / b : 0;
}

// Checked as printf is.
[[gnu::format(printf, 2, 3)]] void add(std::string& text, const char* format, ...) {
  char line[160];
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  text += line;
}

}  // namespace

RunProfiler::RunProfiler()
    : wall_began_s_(seconds_of(CLOCK_MONOTONIC)),
      cpu_began_s_(seconds_of(CLOCK_PROCESS_CPUTIME_ID)) {}

RunProfile RunProfiler::end(double run_s) const {
  return {run_s,
          seconds_of(CLOCK_MONOTONIC) - wall_began_s_,
          seconds_of(CLOCK_PROCESS_CPUTIME_ID) - cpu_began_s_,
          std::max(1, static_cast<int>(std::thread::hardware_concurrency())),
          profile_.parts(),
          profile_.threads()};
}

nlohmann::ordered_json profile_json(const RunProfile& profile) {
  nlohmann::ordered_json result{{"robot_s", profile.run_s},
                                {"wall_s", profile.wall_s},
                                {"cpu_s", profile.cpu_s},
                                {"robot_s_per_wall_s", share(profile.run_s, profile.wall_s)},
                                {"robot_s_per_cpu_s", share(profile.run_s, profile.cpu_s)},
                                {"cores", profile.cores},
                                {"cores_used", share(profile.cpu_s, profile.wall_s)}};
  auto& parts = result["parts"] = nlohmann::ordered_json::array();
  for (const auto& part : profile.parts)
    parts.push_back({{"name", part.name},
                     {"cpu_s", part.cpu_s},
                     {"cpu_share", share(part.cpu_s, profile.cpu_s)},
                     {"waiting_s", part.waiting_s},
                     {"count", part.count}});
  const double other_s = other_cpu_s(profile);
  parts.push_back(
      {{"name", "other"}, {"cpu_s", other_s}, {"cpu_share", share(other_s, profile.cpu_s)}});
  auto& threads = result["threads"] = nlohmann::ordered_json::array();
  for (const auto& thread : profile.threads)
    threads.push_back({{"name", thread.name},
                       {"cpu_s", thread.cpu_s},
                       {"share_of_a_core", share(thread.cpu_s, profile.wall_s)}});
  return result;
}

std::string profile_text(const RunProfile& profile) {
  std::string text;
  add(text, "%-24s %9s %7s %11s %10s\n", "part", "CPU s", "share", "ms/robot s", "waiting s");
  const auto row = [&](const char* name, double cpu_s) {
    add(text, "%-24.24s %9.3f %5.1f %% %11.2f", name, cpu_s, 100 * share(cpu_s, profile.cpu_s),
        1e3 * share(cpu_s, profile.run_s));
  };
  for (const auto& part : profile.parts) {
    row(part.name.c_str(), part.cpu_s);
    add(text, " %10.3f\n", part.waiting_s);
  }
  row("other", other_cpu_s(profile));
  add(text, "\n");
  row("all", profile.cpu_s);
  add(text,
      "\n"
      "%.1f s of robot time in %.2f s: %.1f times real time; %.1f robot-seconds per CPU second\n",
      profile.run_s, profile.wall_s, share(profile.run_s, profile.wall_s),
      share(profile.run_s, profile.cpu_s));
  add(text,
      "%.2f of %d cores used; threads, share of a core:", share(profile.cpu_s, profile.wall_s),
      profile.cores);
  for (const auto& thread : profile.threads)
    add(text, " %s %.0f %%%s", thread.name.c_str(), 100 * share(thread.cpu_s, profile.wall_s),
        &thread == &profile.threads.back() ? "\n" : ",");
  return text;
}

}  // namespace kaz::tools
