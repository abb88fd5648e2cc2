// The board under the fuzzer: engine, motors, line, faults, judges.
// SPDX-License-Identifier: Apache-2.0
#include "tools/fuzz/engine_case.h"

#include <algorithm>
#include <array>

#include "hil/fuzz/tick_judge.h"
#include "host/link/interruptible.h"
#include "shared/board/table.h"
#include "sim/runtime/simulation/simulation.h"
#include "tools/fuzz/plant.h"
#include "tools/fuzz/shadow.h"
#include "tools/lockstep/lockstep.h"

namespace kaz::fuzz {
namespace {

constexpr const char* kJointNames[KZ_JOINTS] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) #name,
#include "shared/board/joints.def"
#undef KZ_JOINT
};

// The drivers obey a tick's output in the tick after, and steps of the world lie across ticks.
constexpr int kDriveLag = 3;
// Pushed so recently, a joint that passes its limit has been driven past it.
constexpr int kPushedMs = 100;

// So far past a soft limit a host can drive a joint at most at 10 V, as
// sim/body/motor/joint_limits_test.cpp
// states and shows for one joint.
constexpr double kLimitMargin = 0.03;  // rad

// Judge of the motors and joints of the world themselves.
class BodyJudge {
 public:
  // `healthy`: no sensor, motor or supply has a fault.
  explicit BodyJudge(bool healthy) : healthy_(healthy) {}
  // After each tick.
  void board(const kz_servo& servo) {
    servo_ = &servo;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      const bool on = (servo.enabled >> j & 1) != 0 || (servo.raw_ms != 0 && servo.raw_joint == j);
      joints_[j].off_ticks = on ? 0 : joints_[j].off_ticks + 1;
    }
  }
  void restart() {
    for (Joint& joint : joints_) joint = {};
  }
  void step(std::span<const sim::MotorDrive> drives, std::span<const sim::JointState> joints) {
    if (servo_ == nullptr) return;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) judge(j, drives[j], joints[j]);
  }
  double worst_overshoot() const { return worst_; }
  const std::optional<std::string>& violation() const { return violation_; }

 private:
  struct Joint {
    int off_ticks = kDriveLag;
    bool inside = false;                                       // since it was switched on
    int pushed_up_ms = kPushedMs, pushed_down_ms = kPushedMs;  // ago
  };

  void judge(std::size_t j, const sim::MotorDrive& drive, const sim::JointState& state) {
    Joint& joint = joints_[j];
    const bool off = joint.off_ticks > kDriveLag;
    if (off && drive.powered && drive.duty != 0 && !violation_)
      violation_ = std::string(kJointNames[j]) + " is off, but its motor has duty " +
                   std::to_string(drive.duty);
    const kz_joint& servo = servo_->joint[j];
    // The angle as the board would measure it without noise, by the calibration that it uses now.
    const double ratio = sim::pot_ratio(static_cast<int>(j), state.angle);
    const double angle = servo.pot_centre + (ratio - 0.5) * 2.0 * servo.pot_scale;
    joint.pushed_up_ms = drive.powered && drive.duty > 0 ? 0 : joint.pushed_up_ms + 1;
    joint.pushed_down_ms = drive.powered && drive.duty < 0 ? 0 : joint.pushed_down_ms + 1;
    if (joint.off_ticks > 0) {
      joint.inside = false;
      return;
    }
    if (angle >= servo.lower && angle <= servo.upper) joint.inside = true;
    if (servo.lower != lower_[j] || servo.upper != upper_[j]) {
      joint.inside = false;  // limits that were drawn in around it
      lower_[j] = servo.lower;
      upper_[j] = servo.upper;
    }
    if (!joint.inside) return;
    double past = 0;
    if (joint.pushed_up_ms < kPushedMs) past = std::max(past, 1e-4 * (angle - servo.upper));
    if (joint.pushed_down_ms < kPushedMs) past = std::max(past, 1e-4 * (servo.lower - angle));
    worst_ = std::max(worst_, past);
    if (healthy_ && past > kLimitMargin && !violation_)
      violation_ = std::string(kJointNames[j]) + " was driven " + std::to_string(past) +
                   " rad past its soft limit";
  }

  const bool healthy_;
  const kz_servo* servo_ = nullptr;
  std::array<Joint, KZ_JOINTS> joints_{};
  std::array<int, KZ_JOINTS> lower_{}, upper_{};
  double worst_ = 0;
  std::optional<std::string> violation_;
};

struct Engine {
  std::unique_ptr<sim::Mcu> mcu;
  const sim::H8Mcu* h8 = nullptr;
};

Result<Engine> make_engine(const EngineOptions& options) {
  if (options.mcu == sim::McuKind::native) return Engine{sim::make_native(), nullptr};
  auto h8 = KAZ_TRY(sim::H8Mcu::load(options.image));
  if (!h8->has_tick_symbols())
    return fail(Fault::usage, options.image +
                                  " has no symbols of the servo's tick; put the .coff file of "
                                  "the same build into the same folder");
  const sim::H8Mcu* known = h8.get();
  return Engine{std::move(h8), known};
}

Result<std::unique_ptr<sim::World>> make_world(const EngineOptions& options) {
  if (options.world_path.empty()) return make_motor_bench();
  sim::WorldOptions world;
  world.seed = options.seed;
  world.hung = true;
  return sim::World::load(options.world_path, options.robot_path, world);
}

}  // namespace

Result<EngineVerdict> run_engine_case(const hil::fuzz::Genome& genome,
                                      const EngineOptions& options) {
  auto engine = KAZ_TRY(make_engine(options));
  auto world = KAZ_TRY(make_world(options));

  EngineVerdict verdict;
  BodyJudge body(!options.grammar.faults);
  hil::fuzz::TickJudge ticks;
  std::optional<Shadow> shadow;
  if (engine.h8 != nullptr) shadow.emplace(*engine.h8);
  sim::Mcu& mcu = *engine.mcu;
  std::optional<std::uint32_t> last_tick;
  mcu.on_tick([&](const sim::TickRecord& record) {
    const bool first = !last_tick || record.input.tick <= *last_tick;
    last_tick = record.input.tick;
    if (shadow) shadow->tick(record);
    const kz_servo& servo = shadow ? shadow->servo() : *mcu.servo();
    if (first) {
      ticks.restart();
      body.restart();
    }
    ticks.tick(record.input, servo, record.output);
    body.board(servo);
    verdict.worst_busy_8states = std::max(verdict.worst_busy_8states, record.input.worst_8states);
  });

  sim::SimulationOptions simulated;
  simulated.mcu = options.mcu;
  simulated.seed = options.seed;
  auto simulation = sim::Simulation::assemble(
      simulated, std::move(engine.mcu),
      watched(std::move(world), [&body](auto drives, auto joints) { body.step(drives, joints); }),
      sim::CameraFile{});
  if (!simulation) return tl::unexpected(simulation.error());

  lockstep::LockstepLink raw_link(**simulation);
  lockstep::LockstepClock raw_clock(**simulation);
  host::InterruptibleLink link(raw_link, raw_clock, options.interrupt);
  host::InterruptibleClock clock(raw_clock, options.interrupt);
  hil::fuzz::RunnerOptions runner;
  runner.fault = [&](const faults::Fault& fault) { (*simulation)->add_fault(fault); };
  runner.judge = [&]() -> std::optional<std::string> {
    if (shadow && shadow->difference()) return shadow->difference();
    if (ticks.violation()) return ticks.violation();
    return body.violation();
  };
  const auto events = hil::fuzz::events_of(genome, options.grammar);
  runner.broken_off = &verdict;
  const auto run = hil::fuzz::run_case(link, clock, events, runner);
  if (run) static_cast<hil::fuzz::CaseVerdict&>(verdict) = *run;
  verdict.features.insert(ticks.features().begin(), ticks.features().end());
  verdict.ticks = ticks.ticks();
  if (engine.h8 != nullptr) {
    verdict.emulator_engine = engine.h8->emulator_engine();
    verdict.instructions = engine.h8->chip().instructions();
    verdict.translated_instructions = engine.h8->chip().translated_instructions();
  }
  verdict.worst_overshoot_rad = body.worst_overshoot();
  if (run) return verdict;
  if (options.broken_off != nullptr) *options.broken_off = verdict;
  return tl::unexpected(run.error());
}

}  // namespace kaz::fuzz
