// Servos of Feetech's on a bus.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/feetech_driver.h"

#include <algorithm>
#include <array>

namespace kaz::host {

using feetech::Instruction;
using servo_bus::Register;

namespace {

constexpr std::uint8_t kFirst = 56, kCount = 8;  // present_position .. present_temperature
constexpr const char* kRead[] = {"present_position", "present_speed", "present_load",
                                 "present_voltage", "present_temperature"};

std::uint8_t id_of(const servo_bus::BusServo& servo) {
  return static_cast<std::uint8_t>(servo.id);
}

std::uint8_t address_of(const Register& reg) {
  return static_cast<std::uint8_t>(reg.address);
}

std::uint8_t trouble_of(std::uint8_t status) {
  const auto reported = [status](int bits, ServoTrouble trouble) {
    return (status & bits) != 0 ? trouble : ServoTrouble{};
  };
  return static_cast<std::uint8_t>(
      reported(feetech::kVoltageError, kTroubleVoltage) |
      reported(feetech::kEncoderError | feetech::kAngleError, kTroubleSensor) |
      reported(feetech::kTemperatureError, kTroubleHeat) |
      reported(feetech::kOverloadError | feetech::kCurrentError, kTroubleOverload));
}

}  // namespace

Result<std::optional<int>> FeetechDriver::read(const Servo& servo, std::string_view name) {
  const Register& reg = *servo.model->find(name);
  const auto answer = KAZ_TRY(exchange_.query(
      feetech::request(id_of(servo), Instruction::read, {address_of(reg), reg.size}), reg.size));
  if (!answer) return std::optional<int>();
  return std::optional<int>(servo_bus::decode(*servo.model, reg, answer->parameters));
}

Result<std::optional<std::vector<std::uint8_t>>> FeetechDriver::read_block(const Servo& servo,
                                                                           std::string_view first,
                                                                           std::size_t count) {
  const auto answer = KAZ_TRY(exchange_.query(
      feetech::request(id_of(servo), Instruction::read,
                       {address_of(*servo.model->find(first)), static_cast<std::uint8_t>(count)}),
      count));
  return answer ? std::optional(answer->parameters) : std::nullopt;
}

Result<bool> FeetechDriver::write(const Servo& servo, std::string_view name, int value) {
  const Register& reg = *servo.model->find(name);
  std::vector<std::uint8_t> parameters{address_of(reg)};
  std::ranges::copy(servo_bus::encode(*servo.model, reg, value), std::back_inserter(parameters));
  const auto request = feetech::request(id_of(servo), Instruction::write, std::move(parameters));
  return KAZ_TRY(exchange_.query(request, 0)).has_value();
}

Result<void> FeetechDriver::write_all(Servos servos, std::string_view name, int value) {
  if (servos.empty()) return {};
  // The same place in all models.
  const Register& first = *servos.front()->model->find(name);
  std::vector<std::uint8_t> parameters{address_of(first), first.size};
  for (const Servo* servo : servos) {
    parameters.push_back(id_of(*servo));
    std::ranges::copy(servo_bus::encode(*servo->model, first, value),
                      std::back_inserter(parameters));
  }
  return exchange_.send(
      feetech::request(feetech::kBroadcast, Instruction::sync_write, std::move(parameters)));
}

Result<std::optional<BusDriver::Greeting>> FeetechDriver::greet(const Servo& servo) {
  // No ping: the answer of a servo whose voltage is wrong has the bytes of the ping itself, and would pass
  // for an adapter's echo.
  Greeting greeting;
  greeting.model = KAZ_TRY(read(servo, "model"));
  if (!greeting.model) return std::optional<Greeting>();
  if (servo.model->find("mode") != nullptr) greeting.mode = KAZ_TRY(read(servo, "mode"));
  // The board's ramps are the profile: the servo's own acceleration would make each target late.
  constexpr std::string_view kAcceleration = "acceleration";
  if (greeting.model == servo.model->number && servo.model->find(kAcceleration) != nullptr &&
      !KAZ_TRY(set(servo, kAcceleration, 0)))
    greeting.refused = kAcceleration;
  return std::optional<Greeting>(greeting);
}

Result<std::vector<std::optional<ServoState>>> FeetechDriver::read_all(Servos servos) {
  std::optional<feetech::Packet> together;
  if (std::ranges::all_of(servos, [](const Servo* servo) { return servo->model->sync_read; })) {
    std::vector<std::uint8_t> parameters{kFirst, kCount};
    for (const Servo* servo : servos) parameters.push_back(id_of(*servo));
    together = feetech::request(feetech::kBroadcast, Instruction::sync_read, parameters);
  }
  const auto answers =
      KAZ_TRY(exchange_.query_all(servos, together, kCount, [](const Servo& servo) {
        return feetech::request(id_of(servo), Instruction::read, {kFirst, kCount});
      }));
  std::vector<std::optional<ServoState>> states(servos.size());
  for (std::size_t i = 0; i < servos.size(); ++i) {
    if (!answers[i]) continue;
    const servo_bus::Model& model = *servos[i]->model;
    std::array<int, std::size(kRead)> values{};
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Register& reg = *model.find(kRead[k]);
      values[k] = servo_bus::decode(
          model, reg,
          std::span(answers[i]->parameters).subspan(reg.address - std::size_t{kFirst}, reg.size));
    }
    states[i] = {.steps = static_cast<double>(values[0]),
                 .speed = static_cast<double>(values[1]),
                 .duty = values[2] / 1000.0,
                 .volts = values[3] / 10.0,
                 .celsius = static_cast<double>(values[4]),
                 .trouble = trouble_of(answers[i]->code)};
  }
  return states;
}

// One write for all servos of a model: goal, time and speed.
Result<void> FeetechDriver::move(std::span<const Goal> goals) {
  for (const servo_bus::Model& model : servo_bus::models()) {
    std::vector<std::uint8_t> parameters;
    for (const Goal& goal : goals) {
      if (goal.servo->model != &model) continue;
      std::vector<std::uint8_t> bytes;
      const auto add = [&](const char* name, double value) {
        const Register& reg = *model.find(name);
        const long limited = std::clamp(std::lround(value), long{reg.min}, long{reg.max});
        std::ranges::copy(servo_bus::encode(model, reg, static_cast<int>(limited)),
                          std::back_inserter(bytes));
      };
      add("goal_position", goal.steps);
      add("goal_time", 0);
      add("goal_speed", std::max(1.0, goal.speed));
      if (parameters.empty())
        parameters = {address_of(*model.find("goal_position")),
                      static_cast<std::uint8_t>(bytes.size())};
      parameters.push_back(id_of(*goal.servo));
      parameters.insert(parameters.end(), bytes.begin(), bytes.end());
    }
    if (parameters.empty()) continue;
    KAZ_TRY(exchange_.send(
        feetech::request(feetech::kBroadcast, Instruction::sync_write, std::move(parameters))));
  }
  return {};
}

// A goal ends an overload; it also switches the torque on.
Result<std::vector<bool>> FeetechDriver::recover(std::span<const Goal> troubled) {
  std::vector<bool> accepted;
  for (const Goal& one : troubled)
    accepted.push_back(
        KAZ_TRY(set(*one.servo, "goal_position", static_cast<int>(std::lround(one.steps)))));
  return accepted;
}

}  // namespace kaz::host
