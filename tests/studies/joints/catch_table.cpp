// catch_table: catches of nominal robots, robots as built, and the same after their joints were calibrated.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>

#include <CLI/CLI.hpp>

#include "tools/base/paths.h"
#include "tools/eval/judge.h"
#include "tools/lockstep/calibrated_joints.h"
#include "tools/run/run.h"

namespace {

using namespace kaz;

constexpr double kHeld_s = 3;  // clear of the floor, up to the end
constexpr std::array kVariants{"nominal", "as built", "as built, calibrated"};

tools::BackendOptions backend_of(std::uint64_t seed, std::size_t variant) {
  tools::BackendOptions backend;
  backend.world = "catch";
  backend.mcu = sim::McuKind::native;
  backend.eyes = sim::EyeKind::real;
  backend.imu = true;
  backend.seed = seed;
  backend.sensors = variant == 0 ? sim::SensorSet::nominal : sim::SensorSet::as_built;
  return backend;
}

// The flash of a board whose joints were calibrated, on the floor of the world `empty`.
Result<std::string> calibrated_memory(tools::BackendOptions backend) {
  sim::SimulationOptions options;
  options.seed = backend.seed;
  options.imu = true;
  options.sensors = backend.sensors;
  options.world_path = KAZ_TRY(tools::world_file("empty"));
  options.robot_path = KAZ_TRY(tools::data_file("robot/kaz/kaz.urdf"));
  options.camera_path = KAZ_TRY(tools::data_file("robot/kaz/camera.json"));
  return lockstep::calibrated_memory(options);
}

Result<bool> caught(std::uint64_t seed, std::size_t variant) {
  tools::Judge judge({.ball_radius_m = 0.020});
  tools::RunOptions run;
  run.backend = backend_of(seed, variant);
  if (variant == 2) run.backend.memory = KAZ_TRY(calibrated_memory(run.backend));
  run.behavior = "catch-ball";
  run.quiet = true;
  run.json = true;
  const auto claimed = KAZ_TRY(tools::run(run, judge));
  const bool held = judge.held_s() >= kHeld_s && !judge.fell();
  std::fprintf(stderr, "seed %llu, %s: %s, held %.1f s%s\n", static_cast<unsigned long long>(seed),
               kVariants[variant], claimed ? "claims it" : "no catch", judge.held_s(),
               judge.fell() ? ", fell" : "");
  return claimed && held;
}

Result<void> run(std::uint64_t first, std::uint64_t seeds) {
  std::array<int, kVariants.size()> successes{};
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    for (std::size_t variant = 0; variant < kVariants.size(); ++variant) {
      const bool success = KAZ_TRY(caught(seed, variant));
      successes[variant] += success ? 1 : 0;
    }
  }
  std::printf("| robot | caught |\n|---|---|\n");
  for (std::size_t variant = 0; variant < kVariants.size(); ++variant)
    std::printf("| %s | %d of %llu |\n", kVariants[variant], successes[variant],
                static_cast<unsigned long long>(seeds));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t first = 1, seeds = 20;
  CLI::App app(
      "Catches in the world `catch`, by ground truth: held clear of the floor for the last 3 s.");
  app.add_option("--first", first, "first seed");
  app.add_option("--seeds", seeds, "how many robots")->check(CLI::Range(1, 10000));
  CLI11_PARSE(app, argc, argv);
  const auto done = run(first, seeds);
  if (!done) std::fprintf(stderr, "catch_table: %s\n", done.error().message.c_str());
  return done ? 0 : 1;
}
