// Numbers that other programs of the build measure: the parts' benchmarks, and the whole loop.
// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "shared/base/bounded_json.hpp"
#include "shared/base/files.hpp"
#include "shared/base/shell_word.hpp"
#include "tools/benchmark/benchmark.h"
#include "tools/benchmark/body/names.h"

namespace kaz::bench {
namespace {

namespace fs = std::filesystem;

// A number that a benchmark counts beside its time.
struct Counter {
  std::string gives, run, counter;
};

// A benchmark program of a part (Google Benchmark) and those of its names that are the project's.
struct Program {
  const char* name;
  const char* time;  // which of its times counts
  std::vector<std::string> gives;
  std::vector<Counter> counters = {};
};

// The names of `dynamics.`: tools/benchmark/body/body_benchmark.cpp.
Program dynamics() {
  using sim::bench::name_of;
  Program program{"body_benchmark", "cpu_time", {name_of("step_us", "walking")}};
  for (const char* load : sim::bench::kLoads) {
    for (const char* stepper : sim::bench::kSteppers) {
      const std::string run = name_of("step_us", load, stepper);
      program.gives.push_back(run);
      for (const std::string what : {"gap_um", "track_mrad"})
        program.counters.push_back({name_of(what, load, stepper), run, what});
    }
    program.gives.push_back(name_of("collision_us", load));
  }
  for (const char* load : sim::bench::kWorldLoads) {
    program.gives.push_back(name_of("load_ms", load));
    program.gives.push_back(name_of("clone_us", load));
  }
  program.gives.emplace_back(sim::bench::kWorldsUs);
  program.counters.push_back({sim::bench::kWorldsX, sim::bench::kWorldsUs, "x"});
  return program;
}

// What Google Benchmark appends to the name of a run whose time is that of all threads.
constexpr const char* kAllThreads = "/process_time";

const std::vector<Program>& programs() {
  static const std::vector<Program> all{
      dynamics(),
      {"view_benchmark",
       "real_time",
       {"view.pair_ms.320", "view.pair_ms.640", "view.sensor_ms.320", "view.sensor_ms.640",
        "view.real_pair_ms.320", "view.real_pair_ms.640", "view.pair_ms.320.raster",
        "view.pair_ms.640.raster", "view.real_pair_ms.320.raster", "view.real_pair_ms.640.raster"}},
      {"vision_benchmark",
       "cpu_time",
       {"vision.color_ms.320", "vision.color_ms.640", "vision.regions_ms.320",
        "vision.regions_ms.640", "vision.ball_ms.320", "vision.ball_ms.640", "vision.depth_ms.320",
        "vision.depth_ms.640", "peer.opencv_stereobm_ms.320", "peer.opencv_stereobm_ms.640",
        "vision.psf_ms.320", "vision.psf_ms.640", "peer.opencv_color_ms.yuv.320",
        "peer.opencv_color_ms.yuv.640", "peer.opencv_color_ms.hsv.320",
        "peer.opencv_color_ms.hsv.640", "peer.opencv_regions_ms.320",
        "peer.opencv_regions_ms.640"}},
      {"map_benchmark",
       "cpu_time",
       {"vision.edges_ms.320", "vision.edges_ms.640", "vision.map_ms.320", "vision.map_ms.640",
        "vision.pipeline_ms.320", "vision.pipeline_ms.640"}},
      {"flow_benchmark",
       "cpu_time",
       {"vision.flow_ms.320", "vision.flow_ms.640", "peer.opencv_dis_ms.320",
        "peer.opencv_dis_ms.640", "vision.moving_ms.320", "vision.moving_ms.640"}},
  };
  return all;
}

fs::path beside_this(const std::string& program) {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path() / program;
}

// What a command writes to standard output, as JSON.
Result<nlohmann::json> json_of(const std::string& command) {
  std::FILE* output = ::popen(command.c_str(), "r");
  if (!output) return fail(Fault::environment, "cannot start: " + command);
  std::string text;
  char part[4096];
  while (const std::size_t n = std::fread(part, 1, sizeof part, output)) text.append(part, n);
  const int status = ::pclose(output);
  // The spread of a counter that is 0 throughout is 0/0; Google Benchmark writes it as it is.
  text = std::regex_replace(text, std::regex(": -?(NaN|Infinity)\\b"), ": null");
  auto value = parse_bounded_json(text);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !value)
    return fail(Fault::failed, "this command failed or printed no JSON: " + command);
  return value;
}

Result<void> measure(const Program& program, const Settings& settings, Results& results) {
  const fs::path path = beside_this(program.name);
  if (!fs::exists(path)) {
    results.remark(
        std::string(program.name) +
        " is not built, so its numbers are left out; install libbenchmark-dev and build again");
    return {};
  }
  std::string filter;
  for (const auto& name : program.gives) filter += (filter.empty() ? "" : "|") + name;
  std::string command = shell_word(path.string());
  command += " --benchmark_format=json --benchmark_filter=" +
             shell_word("^(" + filter + ")(" + kAllThreads + ")?$");
  command += " --benchmark_repetitions=" + std::to_string(settings.repeats);
  if (settings.quick) command += " --benchmark_min_time=0.01";
  const auto report = KAZ_TRY(json_of(command + " 2>/dev/null"));
  const auto take = [&](const std::string& name, const std::string& from,
                        const char* what) -> Result<void> {
    std::vector<double> values;
    for (const auto& run : report.value("benchmarks", nlohmann::json::array())) {
      const std::string ran = run.value("run_name", "");
      if ((ran == from || ran == from + kAllThreads) && run.value("run_type", "") == "iteration" &&
          !run.value("error_occurred", false))
        values.push_back(run.value(what, 0.0));
    }
    if (values.empty()) return fail(Fault::failed, path.string() + " does not measure " + name);
    results.put(name, median(values));
    return {};
  };
  Result<void> done;
  for (const auto& name : program.gives) {
    if (done) done = take(name, name, program.time);
  }
  for (const Counter& counter : program.counters) {
    if (done) done = take(counter.gives, counter.run, counter.counter.c_str());
  }
  return done;
}

// All 18 targets out and 18 positions back over the line of 115,200 baud.
Result<void> wire(const Settings&, Results& results) {
  const fs::path program = beside_this("wire_benchmark");
  if (!fs::exists(program)) {
    results.remark("wire_benchmark is not built, so the numbers wire.* are left out");
    return {};
  }
  const auto report = KAZ_TRY(json_of(shell_word(program.string())));
  const auto number = [&](const char* load, const char* name) {
    return report.value(load, nlohmann::json::object()).value(name, 0.0);
  };
  results.put("wire.rate_hz", number("fastest", "rate_hz"));
  results.put("wire.share",
              100 * std::max(number("at_100_hz", "share_out"), number("at_100_hz", "share_in")));
  return {};
}

// An erased board flashed through boot mode.
Result<void> flashing(const Settings&, Results& results) {
  const fs::path program = beside_this("flash_efficiency");
  if (!fs::exists(program)) {
    results.remark("flash_efficiency is not built, so the number flash.efficiency is left out");
    return {};
  }
  const auto report = KAZ_TRY(json_of(shell_word(program.string())));
  results.put("flash.efficiency", 100 * report.value("efficiency", 0.0));
  return {};
}

// Paths on random maps, by each planner.
Result<void> planning(const Settings& settings, Results& results) {
  const fs::path program = beside_this("plan_benchmark");
  if (!fs::exists(program)) {
    results.remark("plan_benchmark is not built, so the numbers plan.* are left out");
    return {};
  }
  const auto report =
      KAZ_TRY(json_of(shell_word(program.string()) + " --json " + (settings.quick ? "10" : "200")));
  for (const std::string planner : {"grid", "ompl"}) {
    if (!report.contains(planner)) {
      results.remark("plan_benchmark was built without libompl-dev, so the numbers plan.*." +
                     planner + " are left out");
      continue;
    }
    const nlohmann::json& of = report.at(planner);
    results.put("plan.median_ms." + planner, of.value("median_ms", 0.0));
    results.put("plan.p99_ms." + planner, of.value("p99_ms", 0.0));
    results.put("plan.over." + planner, of.value("over_percent", 0.0));
  }
  return {};
}

// The main job in lockstep: servo firmware, physics, eyes and vision.
Result<void> loop(const Settings& settings, Results& results) {
  const fs::path kaz = beside_this("kaz");
  if (!fs::exists(kaz)) {
    results.remark("kaz is not built, so the number loop.rtf is left out");
    return {};
  }
  const auto made = KAZ_TRY(make_temporary_folder("kaz-bench-loop-"));
  const fs::path out = made;
  const std::string command =
      shell_word(kaz.string()) + " demo --json --out " + shell_word(out.string()) + " 2>/dev/null";
  std::vector<double> speeds;
  Result<void> done;
  for (int k = 0; k < (settings.quick ? 1 : 3) && done; ++k) {
    const auto report = json_of(command);
    if (report)
      speeds.push_back(report->value("rtf", 0.0));
    else
      done = tl::unexpected(report.error());
  }
  std::error_code ignored;
  fs::remove_all(out, ignored);
  if (!speeds.empty() && done) results.put("loop.rtf", median(speeds));
  return done;
}

// The catch of ./tools/dev demo, by vision modules and renderer: seconds of the robot in a second of CPU
// time, which a busy machine shows as well.
Result<void> one_catch(const std::string& gives, const std::string& options, Results& results) {
  const fs::path kaz = beside_this("kaz");
  if (!fs::exists(kaz)) {
    results.remark("kaz is not built, so the number loop.catch_x is left out");
    return {};
  }
  const auto made = KAZ_TRY(make_temporary_folder("kaz-bench-catch-"));
  const fs::path out = made;
  const auto report = json_of(shell_word(kaz.string()) +
                              " run catch-ball --world catch --eyes real --imu --profile --json" +
                              options + " --out " + shell_word(out.string()) + " 2>/dev/null");
  std::error_code ignored;
  fs::remove_all(out, ignored);
  if (!report) return tl::unexpected(report.error());
  results.put(gives,
              report->value("profile", nlohmann::json::object()).value("robot_s_per_cpu_s", 0.0));
  return {};
}

std::vector<Group> catches() {
  std::vector<Group> groups;
  for (const auto& [name, modules] :
       {std::pair{"color", ""}, std::pair{"all", " --modules depth,flow,planes,floor,moving"}}) {
    for (const std::string renderer : {"opengl", "raster"}) {
      const std::string gives = std::string("loop.catch_x.") + name + "." + renderer;
      const std::string options = modules + (" --renderer " + renderer);
      groups.push_back({{gives}, [gives, options](const Settings&, Results& results) {
                          return one_catch(gives, options, results);
                        }});
    }
  }
  return groups;
}

}  // namespace

std::vector<Group> program_groups() {
  std::vector<Group> groups{{{"wire.rate_hz", "wire.share"}, wire},
                            {{"flash.efficiency"}, flashing},
                            {{"plan.median_ms.grid", "plan.median_ms.ompl", "plan.p99_ms.grid",
                              "plan.p99_ms.ompl", "plan.over.grid", "plan.over.ompl"},
                             planning},
                            {{"loop.rtf"}, loop}};
  for (Group& group : catches()) groups.push_back(std::move(group));
  for (const Program& program : programs()) {
    std::vector<std::string> gives = program.gives;
    for (const Counter& counter : program.counters) gives.push_back(counter.gives);
    groups.push_back({std::move(gives), [&program](const Settings& settings, Results& results) {
                        return measure(program, settings, results);
                      }});
  }
  groups.push_back(counted_steps());
  return groups;
}

}  // namespace kaz::bench
