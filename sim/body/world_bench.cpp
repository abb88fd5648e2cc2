// What one physics step costs: standing, and moving into a crouch, by stepper and world.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include <benchmark/benchmark.h>

#include "shared/board/board.h"
#include "sim/body/world.h"

namespace {

using namespace kaz::sim;

void run(benchmark::State& state, const char* world_path, const char* stepper, double swing) {
  WorldOptions options;
  options.stepper = stepper;
  auto loaded = World::load(world_path, KAZ_TREE "/shared/robot/kaz/kaz.urdf", options);
  if (!loaded) {
    state.SkipWithError(loaded.error().message.c_str());
    return;
  }
  World& world = **loaded;
  std::array<MotorDrive, KZ_JOINTS> drives{};
  for (auto _ : state) {
    // All joints swing a little: none of them rests in its stiction.
    const double target = swing * std::sin(2 * M_PI * world.time_s());
    for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
      const JointState& joint = world.joints()[i];
      drives[i] = {20 * (target - joint.angle) - 0.15 * joint.velocity, true};
    }
    world.step(drives, 10.0);
  }
  state.counters["gap_mm"] = world.largest_joint_gap_m() * 1e3;
}

constexpr const char* kEmpty = KAZ_TREE "/sim/worlds/empty.sdf";
constexpr const char* kBall = KAZ_TREE "/sim/worlds/ball.sdf";

BENCHMARK_CAPTURE(run, standing_quick20, kEmpty, "quick20", 0.0);
BENCHMARK_CAPTURE(run, standing_quick50, kEmpty, "quick50", 0.0);
BENCHMARK_CAPTURE(run, standing_exact, kEmpty, "exact", 0.0);
// What runs by default, with every motor at work.
BENCHMARK_CAPTURE(run, swinging_quick50, kEmpty, "quick50", 0.05)
    ->Name("dynamics.step_us.walking")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(run, swinging_exact, kEmpty, "exact", 0.05);
BENCHMARK_CAPTURE(run, standing_with_ball_quick50, kBall, "quick50", 0.0);

}  // namespace

BENCHMARK_MAIN();
