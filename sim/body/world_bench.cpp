// What one physics step costs, and what finding contacts alone: by stepper and by world.
// SPDX-License-Identifier: Apache-2.0
//
// Beside the time: gap_um, the largest gap between the halves of a joint, and track_mrad, the root
// mean square error of the joints against what they were told. "Walking" is the load of a gait:
// every motor at work under a position loop, both feet on the floor. The robot of "alone" stands in
// the walking crouch.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>

#include "shared/board/board.h"
#include "sim/body/staged_world.h"

namespace {

using namespace kaz::sim;

constexpr const char* kEmpty = KAZ_TREE "/sim/worlds/empty.sdf";
constexpr const char* kProps = KAZ_TREE "/sim/worlds/props.sdf";
constexpr const char* kRobot = KAZ_TREE "/shared/robot/kaz/kaz.urdf";

// Crouch of docs/robot.md, joint numbers of joints.def, degrees.
constexpr std::array<double, KZ_JOINTS> kCrouch{0, 0, 10,    12,   -40,   0, 10,    -12,  -40,
                                                0, 0, -30.8, 55.6, -27.8, 0, -30.8, 55.6, -27.8};
constexpr double kServoGain = 20, kServoDamping = 0.15;  // per rad, and s per rad

class Servo {
 public:
  Servo(World& world, double swing) : world_(world), swing_(swing) {}
  void step() {
    const double t = world_.time_s(), into = std::min(1.0, t);
    for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
      const double target = into * kCrouch[i] * M_PI / 180 + swing_ * into * std::sin(2 * M_PI * t);
      const JointState& joint = world_.joints()[i];
      const double error = target - joint.angle;
      const double duty = kServoGain * error - kServoDamping * joint.velocity;
      drives_[i] = {std::clamp(duty, -1.0, 1.0), true};
      if (t > 1.0) squares_ += error * error;
    }
    if (t > 1.0) errors_ += KZ_JOINTS;
    world_.step(drives_, 10.0);
  }
  double error_mrad() const { return 1e3 * std::sqrt(squares_ / std::max(1.0, errors_)); }

 private:
  World& world_;
  double swing_, squares_ = 0, errors_ = 0;
  std::array<MotorDrive, KZ_JOINTS> drives_{};
};

std::unique_ptr<World> load(benchmark::State& state, const char* path, const std::string& stepper) {
  WorldOptions options;
  options.stepper = stepper;
  auto loaded = World::load(path, kRobot, options);
  if (loaded) return std::move(*loaded);
  state.SkipWithError(loaded.error().message.c_str());
  return nullptr;
}

void step(benchmark::State& state, const char* path, const std::string& stepper, double swing) {
  const auto world = load(state, path, stepper);
  if (!world) return;
  Servo servo(*world, swing);
  for (int i = 0; i < 2000; ++i) servo.step();  // crouched, things at rest
  for (auto _ : state) servo.step();
  state.counters["gap_um"] = world->largest_joint_gap_m() * 1e6;
  state.counters["track_mrad"] = servo.error_mrad();
}

// At the state that the steps before led to, again and again.
void collision(benchmark::State& state, const char* path, double swing) {
  const auto world = load(state, path, "quick50");
  if (!world) return;
  Servo servo(*world, swing);
  for (int i = 0; i < 2700; ++i)
    servo.step();  // the second crouch; the ball rolls where there is one
  auto& stage = dynamic_cast<StagedWorld&>(*world);
  int points = 0;
  for (auto _ : state) benchmark::DoNotOptimize(points = stage.find_contacts());
  state.counters["points"] = points;
}

constexpr double kSwing = 0.05;  // rad

void register_all() {
  struct Load {
    const char* name;
    const char* world;
    double swing;
  };
  constexpr Load loads[] = {
      {"alone", kEmpty, 0}, {"walking", kEmpty, kSwing}, {"props", kProps, kSwing}};
  // What runs by default, with every motor at work.
  benchmark::RegisterBenchmark("dynamics.step_us.walking", [](benchmark::State& state) {
    step(state, kEmpty, WorldOptions{}.stepper, kSwing);
  })->Unit(benchmark::kMicrosecond);
  for (const Load& load : loads) {
    const std::string name = load.name;
    for (const std::string stepper : {"exact", "quick8", "quick20", "quick50"}) {
      benchmark::RegisterBenchmark(
          ("dynamics.step_us." + name + "." + stepper).c_str(),
          [=](benchmark::State& state) { step(state, load.world, stepper, load.swing); })
          ->Unit(benchmark::kMicrosecond);
    }
    benchmark::RegisterBenchmark(
        ("dynamics.collision_us." + name).c_str(),
        [=](benchmark::State& state) { collision(state, load.world, load.swing); })
        ->Unit(benchmark::kMicrosecond);
  }
}

}  // namespace

int main(int argc, char** argv) {
  register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
