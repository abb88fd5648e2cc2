// Replays the goals of a servo's log on a virtual bus.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/servo_replay.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>

#include "shared/dynamixel/packet.h"
#include "shared/feetech/packet.h"
#include "sim/body/world/staged_world.h"
#include "sim/bus/feetech_motion.h"
#include "sim/bus/virtual_bus.h"

namespace kaz::tools {
namespace {

constexpr double kGravity = 9.80665;  // m/s2
constexpr double kDynamixelFullPwm = 885;
constexpr std::chrono::milliseconds kSwitchOn{200};  // longer than any command delay

// A point mass with the log's inertia and gravity torque. Joint angle 0 is the arm's start at `angle_rad`
// from straight down.
sim::RobotModel pendulum_of(const hil::ServoLog& log, double angle_rad) {
  const double length = log.load_kgm2() * kGravity / log.gravity_nm();
  sim::RobotModel robot;
  robot.name = "pendulum";
  robot.fixed_base = true;
  robot.links.resize(2);
  robot.links[0].rigid.name = "world";
  sim::RobotLink& arm = robot.links[1];
  arm.rigid.name = "arm";
  arm.rigid.mass = log.gravity_nm() / (kGravity * length);
  arm.rigid.com = length * Eigen::Vector3d(std::sin(angle_rad), 0, -std::cos(angle_rad));
  arm.rigid.inertia = 1e-7 * Eigen::Matrix3d::Identity();
  arm.at_zero.translation().z() = 1;
  arm.parent = 0;
  arm.joint = 0;
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  robot.joints.push_back({"shaft", 1, -Eigen::Vector3d::UnitY(), -kEndless, kEndless});
  for (int i = 0; i < 2; ++i)
    robot.frames[robot.links[static_cast<std::size_t>(i)].rigid.name].link = i;
  return robot;
}

// The virtual servo, and the host that writes to it.
class ReplayedServo {
 public:
  static Result<ReplayedServo> create(const servo_model::IdentifiedServo& servo,
                                      const hil::ServoLog& log, double zero_rad) {
    const servo_bus::Model* model = servo_bus::find_model(servo.servo);
    if (model == nullptr)
      return fail(Fault::usage, "--replay " + servo.servo +
                                    ": unknown model; docs/reference/servo-bus.md lists models");
    sim::MotorParams motor;
    motor.name = servo.servo;
    motor.max_supply_v = 60;
    sim::use_servo(motor, servo);
    sim::WorldModel place;
    place.gravity = {0, 0, -kGravity};
    sim::WorldOptions options;
    options.hung = true;
    const double start = log.samples[0].position_rad;
    auto world =
        KAZ_TRY(sim::make_world(place, pendulum_of(log, start - zero_rad), motor, options));
    servo_bus::BusFile file;
    file.protocol = model->protocol;
    file.baud = 1'000'000;
    file.supply_volts = log.samples[0].volts;
    file.servos = {{"shaft", 1, model, model->steps / 2.0 + start * model->steps_per_rad(), false}};
    return ReplayedServo(KAZ_TRY(sim::VirtualBus::create(std::move(world), file)), *model);
  }

  void write(std::string_view name, int value) {
    const servo_bus::Register* reg = model_->find(name);
    if (reg == nullptr) return;
    const auto data = servo_bus::encode(*model_, *reg, value);
    std::vector<std::uint8_t> bytes;
    if (model_->protocol == servo_bus::Protocol::feetech) {
      bytes.push_back(static_cast<std::uint8_t>(reg->address));
      bytes.insert(bytes.end(), data.begin(), data.end());
      bytes = feetech::wire_of(feetech::request(1, feetech::Instruction::write, bytes));
    } else {
      bytes = {dynamixel::low(reg->address), dynamixel::high(reg->address)};
      bytes.insert(bytes.end(), data.begin(), data.end());
      bytes = dynamixel::wire_of(dynamixel::request(1, dynamixel::Instruction::write, bytes));
    }
    // The answer must end before the next request.
    bus_->advance(bus_->write(bytes) + std::chrono::milliseconds(1));
  }
  // Writes the P gain whose duty per rad is `gain`.
  Result<void> write_gain(double gain) {
    const bool feetech = model_->protocol == servo_bus::Protocol::feetech;
    const double exact =
        feetech ? gain / sim::FeetechMotion::kLoggedDutyPerRad
                : gain * kDynamixelFullPwm * model_->position_p_unit / model_->steps_per_rad();
    const char* name = feetech ? "position_p" : "position_p_gain";
    const int p = static_cast<int>(std::lround(std::min(exact, 1e6)));
    if (!model_->find(name)->allows(p) || std::abs(p - exact) > 0.02 * exact)
      return fail(Fault::usage, "gain_per_rad is " + std::to_string(gain) + ": no P gain of the " +
                                    std::string(model_->name) + " is within 2 % of it");
    write(name, p);
    return {};
  }
  void write_goal(double goal_rad) {
    write("goal_position",
          static_cast<int>(std::lround(model_->steps / 2.0 + goal_rad * model_->steps_per_rad())));
  }
  double position_rad() const {
    const int steps = bus_->servo(0).registers().get("present_position");
    return (steps - model_->steps / 2.0) / model_->steps_per_rad();
  }
  sim::VirtualBus& bus() { return *bus_; }

 private:
  ReplayedServo(std::unique_ptr<sim::VirtualBus> bus, const servo_bus::Model& model)
      : bus_(std::move(bus)), model_(&model) {}

  std::unique_ptr<sim::VirtualBus> bus_;
  const servo_bus::Model* model_;
};

}  // namespace

Result<std::vector<double>> replay_log(const servo_model::IdentifiedServo& servo,
                                       const hil::ServoLog& log, double zero_rad) {
  ReplayedServo replayed = KAZ_TRY(ReplayedServo::create(servo, log, zero_rad));
  KAZ_TRY(replayed.write_gain(log.gain_per_rad));
  // Logs of an XL330 at 7.4 V exist, at which it shuts down with its factory settings.
  for (const char* name : {"position_d", "position_i", "min_start_force", "position_d_gain",
                           "position_i_gain", "shutdown"})
    replayed.write(name, 0);
  std::vector<double> positions;
  bool on = false;
  double goal = NAN;
  Time start{};
  for (const hil::ServoSample& one : log.samples) {
    const bool first = positions.empty();
    const Time after = from_seconds(one.time_s - log.samples[0].time_s);
    if (!first) replayed.bus().advance(start + after);
    positions.push_back(replayed.position_rad());
    replayed.bus().set_supply_volts(one.volts);
    if (one.torque_on != on) replayed.write("torque_enable", one.torque_on ? 1 : 0);
    // A write of the goal switches the torque of a Feetech servo on.
    if (one.torque_on && (one.goal_rad != goal || !on)) replayed.write_goal(one.goal_rad);
    on = one.torque_on;
    goal = one.goal_rad;
    if (!first) continue;
    // The prediction, too, starts with the first goal in effect.
    replayed.bus().advance(replayed.bus().time() + kSwitchOn);
    positions[0] = replayed.position_rad();
    start = replayed.bus().time();
  }
  return positions;
}

Result<std::vector<ReplayedLog>> replay_logs(const servo_model::IdentifiedServo& servo,
                                             const hil::ServoFit& fit,
                                             const std::vector<hil::ServoLog>& logs) {
  std::vector<ReplayedLog> all;
  for (const hil::ServoLog& log : logs) {
    const auto replayed = replay_log(servo, log, fit.zero_of(log));
    if (!replayed) return fail(replayed.error().fault, log.name + ": " + replayed.error().message);
    const hil::Prediction made = fit.predict(log);
    ReplayedLog one{log.name};
    for (std::size_t i = 0; i < log.samples.size(); ++i) {
      const double position = log.samples[i].position_rad;
      one.fit_rad += std::abs(made.position_rad[i] - position);
      one.replay_rad += std::abs((*replayed)[i] - position);
      one.distance_rad += std::abs((*replayed)[i] - made.position_rad[i]);
    }
    for (double ReplayedLog::*at :
         {&ReplayedLog::fit_rad, &ReplayedLog::replay_rad, &ReplayedLog::distance_rad})
      one.*at /= static_cast<double>(log.samples.size());
    all.push_back(one);
  }
  return all;
}

}  // namespace kaz::tools
