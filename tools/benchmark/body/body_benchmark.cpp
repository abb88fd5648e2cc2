// What one physics step costs, and what finding contacts alone: by stepper and by load; loading, cloning, and
// many worlds side by side.
// SPDX-License-Identifier: Apache-2.0
//
// Beside the time: gap_um, the largest gap between the halves of a joint in the first 5 s, and
// track_mrad, the root mean square error of the joints against their targets in the last
// second of these. `--count` is for callgrind (tools/benchmark/counted_steps.cpp): it runs each load for
// a while with counting switched off, then some steps of it with counting on, and dumps.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <valgrind/callgrind.h>

#include "shared/board/board.h"
#include "sim/body/world/gait_testing.h"
#include "sim/body/world/staged_world.h"
#include "tools/benchmark/body/names.h"
#include "tools/benchmark/mujoco/mujoco_world.h"

namespace {

using namespace kaz::sim;

constexpr const char* kRobot = KAZ_TREE "/shared/robot/kaz/kaz.urdf";
constexpr double kServoGain = 20, kServoDamping = 0.15;  // per rad, and s per rad
constexpr int kSettled = 5000;                           // steps: standing, or walking in full
constexpr int kCycle = 1000;

// A world, and the position loops that move the robot in it.
class Run {
 public:
  Run(const std::string& load, const std::string& stepper) : walks_(load != "alone") {
    WorldOptions options;
    options.dynamics = stepper;
    const char* world = load == "props" ? "props" : "empty";
    const auto load_world = stepper == "mujoco" ? bench::MujocoWorld::load : World::load;
    auto loaded =
        load_world(KAZ_TREE "/sim/worlds/" + std::string(world) + ".sdf", kRobot, options);
    if (loaded)
      world_ = std::move(*loaded);
    else
      error_ = loaded.error().message;
  }
  // A clone, at the same time of the same motion.
  Run(const Run& other) : walks_(other.walks_) {
    auto clone = other.world_->clone();
    if (clone)
      world_ = std::move(*clone);
    else
      error_ = clone.error().message;
  }
  bool works() const { return world_ != nullptr; }
  const std::string& error() const { return error_; }
  World& world() { return *world_; }

  // Crouched within a second; walking from the third on, in full from the fourth.
  void step() {
    const double t = world_->time_s();
    const double walk = walks_ ? std::clamp(t - 2.0, 0.0, 1.0) : 0.0;
    const bench::Angles targets = bench::walking_angles(walk, t - std::floor(t));
    const double into = std::min(1.0, t);
    for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
      const JointState& joint = world_->joints()[i];
      const double error = into * targets[i] - joint.angle;
      squares_ += error * error;
      drives_[i] = {std::clamp(kServoGain * error - kServoDamping * joint.velocity, -1.0, 1.0),
                    true};
    }
    world_->step(drives_, 10.0);
  }
  void settle(int steps = kSettled) {
    for (int i = 0; i < steps - kCycle; ++i) step();
    squares_ = 0;
    for (int i = 0; i < kCycle; ++i) step();
    gap_um_ = world_->largest_joint_gap_m() * 1e6;
    track_mrad_ = 1e3 * std::sqrt(squares_ / (kCycle * KZ_JOINTS));
  }
  double gap_um() const { return gap_um_; }
  double track_mrad() const { return track_mrad_; }
  bool upright() const { return world_->link_pose("trunk").linear()(2, 2) > 0.8; }

 private:
  bool walks_;
  std::unique_ptr<World> world_;
  std::string error_;
  double squares_ = 0, gap_um_ = 0, track_mrad_ = 0;
  std::array<MotorDrive, KZ_JOINTS> drives_{};
};

void step(benchmark::State& state, const std::string& load, const std::string& stepper) {
  // Repetitions go on where the one before ended.
  static std::map<std::string, std::unique_ptr<Run>> runs;
  auto& run = runs[load + stepper];
  if (!run) {
    run = std::make_unique<Run>(load, stepper);
    if (run->works()) run->settle();
  }
  if (!run->works()) return state.SkipWithError(run->error().c_str());
  for (auto _ : state) run->step();
  if (!run->upright()) return state.SkipWithError("the robot fell");
  state.counters["gap_um"] = run->gap_um();
  state.counters["track_mrad"] = run->track_mrad();
}

// Contacts are looked for in states all over a cycle, one after the other.
class Poses {
 public:
  explicit Poses(const std::string& load) {
    Run ahead(load, "quick20");
    error_ = ahead.error();
    if (!ahead.works()) return;
    ahead.settle();
    for (int k = 0; k < kPoses; ++k) {
      runs_.push_back(std::make_unique<Run>(ahead));
      for (int i = 0; i < kCycle / kPoses; ++i) ahead.step();
    }
  }
  const std::string& error() const { return error_; }
  int find_contacts() {
    auto& world = dynamic_cast<StagedWorld&>(runs_[next_]->world());
    next_ = (next_ + 1) % runs_.size();
    return world.find_contacts();
  }

 private:
  static constexpr int kPoses = 8;
  std::vector<std::unique_ptr<Run>> runs_;
  std::size_t next_ = 0;
  std::string error_;
};

void collision(benchmark::State& state, const std::string& load) {
  static std::map<std::string, std::unique_ptr<Poses>> all;
  auto& poses = all[load];
  if (!poses) poses = std::make_unique<Poses>(load);
  if (!poses->error().empty()) return state.SkipWithError(poses->error().c_str());
  std::int64_t points = 0;
  for (auto _ : state) points += poses->find_contacts();
  state.counters["points"] = static_cast<double>(points) / static_cast<double>(state.iterations());
}

void load(benchmark::State& state, const std::string& load) {
  for (auto _ : state) {
    const Run run(load, WorldOptions{}.dynamics);
    if (!run.works()) return state.SkipWithError(run.error().c_str());
  }
}

// A world amid its gait is cloned so many times, then they are destroyed: both count.
void clone(benchmark::State& state, const std::string& load) {
  Run run(load, WorldOptions{}.dynamics);
  if (!run.works()) return state.SkipWithError(run.error().c_str());
  run.settle();
  std::vector<std::unique_ptr<World>> clones;
  clones.reserve(bench::kWorlds);
  for (auto _ : state) {
    if (clones.size() == bench::kWorlds) clones.clear();
    auto made = run.world().clone();
    if (!made) return state.SkipWithError(made.error().message.c_str());
    clones.push_back(std::move(*made));
  }
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Worlds all over a gait cycle, a step of each in turn; after every round one world steps as often alone.
// `x`: the ratio of both times.
class SideBySide {
 public:
  SideBySide() : alone_("walking", WorldOptions{}.dynamics) {
    if (!alone_.works()) return;
    alone_.settle();
    Run ahead(alone_);
    for (int i = 0; i < bench::kWorlds; ++i) {
      runs_.push_back(std::make_unique<Run>(ahead));
      for (int k = 0; k < kCycle / bench::kWorlds; ++k) ahead.step();
    }
  }
  const std::string& error() const { return alone_.error(); }
  void measure(benchmark::State& state) {
    double together = 0, alone = 0;
    const auto round = [](auto&& step) {
      const double start = cpu_seconds();
      for (int i = 0; i < bench::kWorlds; ++i) step(static_cast<std::size_t>(i));
      return cpu_seconds() - start;
    };
    std::size_t next = 0;
    double start = cpu_seconds();
    for (auto _ : state) {
      runs_[next]->step();
      if (++next < runs_.size()) continue;
      state.PauseTiming();
      together += cpu_seconds() - start;
      alone += round([this](std::size_t) { alone_.step(); });
      next = 0;
      start = cpu_seconds();
      state.ResumeTiming();
    }
    if (together == 0) {  // too few iterations for a round
      together = round([this](std::size_t i) { runs_[i]->step(); });
      alone = round([this](std::size_t) { alone_.step(); });
    }
    state.counters["x"] = together / alone;
  }

 private:
  Run alone_;
  std::vector<std::unique_ptr<Run>> runs_;
};

void side_by_side(benchmark::State& state) {
  static SideBySide worlds;
  if (!worlds.error().empty()) return state.SkipWithError(worlds.error().c_str());
  worlds.measure(state);
}

void register_all() {
  const auto add = [](const std::string& name, auto measure) {
    return benchmark::RegisterBenchmark(name.c_str(), measure)->Unit(benchmark::kMicrosecond);
  };
  for (const std::string load_of : bench::kWorldLoads) {
    add(bench::name_of("load_ms", load_of), [=](benchmark::State& state) {
      load(state, load_of);
    })->Unit(benchmark::kMillisecond);
    add(bench::name_of("clone_us", load_of),
        [=](benchmark::State& state) { clone(state, load_of); });
  }
  add(bench::kWorldsUs, side_by_side);
  // What runs by default.
  add(bench::name_of("step_us", "walking"),
      [](benchmark::State& state) { step(state, "walking", WorldOptions{}.dynamics); });
  for (const std::string load : bench::kLoads) {
    for (const std::string stepper : bench::kSteppers)
      add(bench::name_of("step_us", load, stepper),
          [=](benchmark::State& state) { step(state, load, stepper); });
    add(bench::name_of("collision_us", load),
        [=](benchmark::State& state) { collision(state, load); });
  }
}

// The name of each dump says what it counted, and how many times.
template <class Work>
void count(const std::string& name, int times, const Work& work) {
  CALLGRIND_START_INSTRUMENTATION;
  CALLGRIND_ZERO_STATS;
  for (int i = 0; i < times; ++i) work();
  const std::string spoken = name + "=" + std::to_string(times);
  CALLGRIND_DUMP_STATS_AT(spoken.c_str());
  CALLGRIND_STOP_INSTRUMENTATION;
}

bool count_all() {
  constexpr int kCounted = kCycle / 2;  // left and right cost the same
  for (const std::string load : bench::kLoads) {
    for (const std::string stepper : bench::kSteppers) {
      Run run(load, stepper);
      if (!run.works()) return std::fprintf(stderr, "%s\n", run.error().c_str()), false;
      run.settle();
      count(bench::name_of("step_kinstr", load, stepper), kCounted, [&] { run.step(); });
    }
    Poses poses(load);
    if (!poses.error().empty()) return std::fprintf(stderr, "%s\n", poses.error().c_str()), false;
    count(bench::name_of("collision_kinstr", load), kCounted, [&] { poses.find_contacts(); });
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--count") return count_all() ? 0 : 1;
  register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
