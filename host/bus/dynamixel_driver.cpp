// DYNAMIXEL servos of the X series on a bus.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/dynamixel_driver.h"

#include <algorithm>
#include <cmath>

namespace kaz::host {

using dynamixel::high;
using dynamixel::Instruction;
using dynamixel::low;
using servo_bus::Register;

namespace {

// present_pwm to present_position; present_input_voltage and present_temperature, which change slowly.
constexpr std::string_view kMotion = "present_pwm", kCircuit = "present_input_voltage";
constexpr std::size_t kMotionBytes = 12, kCircuitBytes = 3;
constexpr Time kCircuitPeriod = std::chrono::milliseconds(500);
// 0: the board's ramps are the profile; the servo's own acceleration would make each target late.
constexpr std::string_view kAcceleration = "profile_acceleration";
// profile_velocity and goal_position.
constexpr std::string_view kGoal = "profile_velocity";
constexpr double kFullPwm = 885;
constexpr double kVelocityUnit = 1000.0 / 64;  // 0.229 rpm, steps/s
// A servo that reboots is deaf; how long is not published.
constexpr Time kRebootWithin = std::chrono::seconds(1);

std::uint8_t id_of(const servo_bus::BusServo& servo) {
  return static_cast<std::uint8_t>(servo.id);
}

// Firmware that has the fast reads. ROBOTIS e-Manual, "Protocol 2.0".
int fast_since(const servo_bus::Model& model) {
  return model.name.starts_with("xl330") ? 46 : 45;
}

std::uint8_t trouble_of(int hardware_error) {
  const auto reported = [hardware_error](int bits, ServoTrouble trouble) {
    return (hardware_error & bits) != 0 ? trouble : ServoTrouble{};
  };
  return static_cast<std::uint8_t>(
      reported(dynamixel::kVoltageError | dynamixel::kShockError, kTroubleVoltage) |
      reported(dynamixel::kEncoderError, kTroubleSensor) |
      reported(dynamixel::kTemperatureError, kTroubleHeat) |
      reported(dynamixel::kOverloadError, kTroubleOverload));
}

// Of a block that begins at the register `first`.
int value_in(const servo_bus::Model& model, std::span<const std::uint8_t> block,
             std::string_view first, std::string_view name) {
  const Register& reg = *model.find(name);
  return servo_bus::decode(
      model, reg,
      block.subspan(static_cast<std::size_t>(reg.address - model.find(first)->address), reg.size));
}

}  // namespace

Result<DynamixelDriver::Exchange::Answer> DynamixelDriver::ping(const Servo& servo) {
  return exchange_.query(dynamixel::request(id_of(servo), Instruction::ping), 3);
}

Result<std::optional<int>> DynamixelDriver::read(const Servo& servo, std::string_view name) {
  const Register& reg = *servo.model->find(name);
  const auto answer = KAZ_TRY(
      exchange_.query(dynamixel::request(id_of(servo), Instruction::read,
                                         {low(reg.address), high(reg.address), reg.size, 0}),
                      reg.size));
  if (!answer || answer->parameters.size() != reg.size) return std::optional<int>();
  return std::optional<int>(servo_bus::decode(*servo.model, reg, answer->parameters));
}

Result<std::optional<std::vector<std::uint8_t>>> DynamixelDriver::read_block(const Servo& servo,
                                                                             std::string_view first,
                                                                             std::size_t count) {
  const std::size_t address = servo.model->find(first)->address;
  const auto answer = KAZ_TRY(
      exchange_.query(dynamixel::request(id_of(servo), Instruction::read,
                                         {low(address), high(address), low(count), high(count)}),
                      count));
  if (!answer || answer->parameters.size() != count)
    return std::optional<std::vector<std::uint8_t>>();
  return std::optional(answer->parameters);
}

Result<bool> DynamixelDriver::write(const Servo& servo, std::string_view name, int value) {
  const Register& reg = *servo.model->find(name);
  std::vector<std::uint8_t> parameters{low(reg.address), high(reg.address)};
  std::ranges::copy(servo_bus::encode(*servo.model, reg, value), std::back_inserter(parameters));
  const auto answer = KAZ_TRY(exchange_.query(
      dynamixel::request(id_of(servo), Instruction::write, std::move(parameters)), 0));
  return answer && (answer->error & ~dynamixel::kAlert) == 0;
}

Result<void> DynamixelDriver::write_all(Servos servos, std::string_view name, int value) {
  if (servos.empty()) return {};
  // The same place in all models.
  const Register& first = *servos.front()->model->find(name);
  std::vector<std::uint8_t> parameters{low(first.address), high(first.address), first.size, 0};
  for (const Servo* servo : servos) {
    parameters.push_back(id_of(*servo));
    std::ranges::copy(servo_bus::encode(*servo->model, first, value),
                      std::back_inserter(parameters));
  }
  return exchange_.send(
      dynamixel::request(dynamixel::kBroadcast, Instruction::sync_write, std::move(parameters)));
}

Result<std::optional<BusDriver::Greeting>> DynamixelDriver::greet(const Servo& servo) {
  const auto answer = KAZ_TRY(ping(servo));
  if (!answer || answer->parameters.size() != 3) return std::optional<Greeting>();
  Greeting greeting;
  greeting.model = answer->parameters[0] + 256 * answer->parameters[1];
  if (answer->parameters[2] < fast_since(*servo.model)) may_be_fast_ = false;
  if (greeting.model == servo.model->number) {
    greeting.mode = KAZ_TRY(read(servo, "operating_mode"));
    if (!KAZ_TRY(set(servo, kAcceleration, 0))) greeting.refused = kAcceleration;
  }
  return std::optional<Greeting>(greeting);
}

Result<std::optional<DynamixelDriver::Blocks>> DynamixelDriver::read_fast(
    Servos servos, const std::vector<std::uint8_t>& sync_read, std::size_t count) {
  constexpr int kSilences = 2;
  const auto request =
      dynamixel::request(dynamixel::kBroadcast, Instruction::fast_sync_read, sync_read);
  KAZ_TRY(exchange_.send(request));
  // Error, id and data of each; between them the CRC of all before, whose last one is the packet's.
  const std::size_t each = count + dynamixel::kFastFrame, crc = 2;
  const auto answer =
      KAZ_TRY(exchange_.receive(dynamixel::kBroadcast, servos.size() * each - crc, request));
  if (!answer) {
    if (!was_fast_ && ++fast_silences_ >= kSilences) may_be_fast_ = false;
    return std::optional<Blocks>();
  }
  Blocks blocks;
  for (std::size_t i = 0; i < servos.size(); ++i) {
    const auto part = std::span(answer->parameters).subspan(i * each);
    if (part[1] != id_of(*servos[i])) return std::optional<Blocks>();
    dynamixel::Packet& one = blocks.emplace_back().emplace();
    one.id = part[1];
    one.instruction = answer->instruction;
    one.error = part[0];
    if ((one.error & ~dynamixel::kAlert) == 0)
      one.parameters.assign(part.begin() + 2,
                            part.begin() + 2 + static_cast<std::ptrdiff_t>(count));
  }
  was_fast_ = true;
  return std::optional(std::move(blocks));
}

Result<std::vector<DynamixelDriver::Exchange::Answer>> DynamixelDriver::read_blocks(
    Servos servos, std::string_view first, std::size_t count) {
  if (servos.empty()) return std::vector<Exchange::Answer>();
  // The same place in all models.
  const std::size_t address = servos.front()->model->find(first)->address;
  std::vector<std::uint8_t> parameters{low(address), high(address), low(count), high(count)};
  const auto one = parameters;
  for (const Servo* servo : servos) parameters.push_back(id_of(*servo));
  auto together = Exchange::Answer(
      dynamixel::request(dynamixel::kBroadcast, Instruction::sync_read, parameters));
  // One servo's fast answer is no shorter.
  if (may_be_fast_ && servos.size() > 1) {
    auto fast = KAZ_TRY(read_fast(servos, parameters, count));
    if (fast) return std::move(*fast);
    // A servo may be lost, or an answer: the sync read finds out.
  }
  return exchange_.query_all(servos, together, count, [&one](const Servo& servo) {
    return dynamixel::request(id_of(servo), Instruction::read, one);
  });
}

Result<std::vector<std::optional<ServoState>>> DynamixelDriver::read_all(Servos servos) {
  const auto answers = KAZ_TRY(read_blocks(servos, kMotion, kMotionBytes));
  std::vector<std::optional<ServoState>> states(servos.size());
  for (std::size_t i = 0; i < servos.size(); ++i) {
    if (!answers[i] || answers[i]->parameters.size() != kMotionBytes) continue;
    const servo_bus::Model& model = *servos[i]->model;
    const auto get = [&](const char* name) {
      return value_in(model, answers[i]->parameters, kMotion, name);
    };
    ServoState& state = states[i].emplace();
    state.steps = get("present_position");
    state.speed = kVelocityUnit * get("present_velocity");
    state.duty = get("present_pwm") / kFullPwm;
    if ((answers[i]->error & dynamixel::kAlert) != 0)
      state.trouble = trouble_of(KAZ_TRY(read(*servos[i], "hardware_error_status")).value_or(0));
  }
  if (clock_.now() < circuit_due_) return states;
  circuit_due_ = clock_.now() + kCircuitPeriod;
  const auto circuits = KAZ_TRY(read_blocks(servos, kCircuit, kCircuitBytes));
  for (std::size_t i = 0; i < servos.size(); ++i) {
    if (!states[i] || !circuits[i] || circuits[i]->parameters.size() != kCircuitBytes) continue;
    const auto get = [&](const char* name) {
      return value_in(*servos[i]->model, circuits[i]->parameters, kCircuit, name);
    };
    states[i]->volts = get("present_input_voltage") / 10.0;
    states[i]->celsius = get("present_temperature");
  }
  return states;
}

Result<void> DynamixelDriver::move(std::span<const Goal> goals) {
  if (goals.empty()) return {};
  const Register& first = *goals.front().servo->model->find(kGoal);
  std::vector<std::uint8_t> parameters{low(first.address), high(first.address), 8, 0};
  for (const Goal& goal : goals) {
    const servo_bus::Model& model = *goal.servo->model;
    const auto add = [&](std::string_view name, double value) {
      const Register& reg = *model.find(name);
      const long limited = std::clamp(std::lround(value), long{reg.min}, long{reg.max});
      std::ranges::copy(servo_bus::encode(model, reg, static_cast<int>(limited)),
                        std::back_inserter(parameters));
    };
    parameters.push_back(id_of(*goal.servo));
    add(kGoal, std::max(1.0, goal.speed / kVelocityUnit));
    add("goal_position", goal.steps);
  }
  return exchange_.send(
      dynamixel::request(dynamixel::kBroadcast, Instruction::sync_write, std::move(parameters)));
}

// What its protection switched off, only a reboot lets on again.
Result<std::vector<bool>> DynamixelDriver::recover(std::span<const Goal> troubled) {
  for (const Goal& one : troubled)
    KAZ_TRY(exchange_.query(dynamixel::request(id_of(*one.servo), Instruction::reboot), 0));
  const Time deadline = clock_.now() + kRebootWithin;
  std::vector<bool> accepted;
  for (const Goal& one : troubled) {
    while (!KAZ_TRY(ping(*one.servo)) && clock_.now() < deadline) {
    }
    accepted.push_back(KAZ_TRY(set(*one.servo, kAcceleration, 0)));
  }
  return accepted;
}

}  // namespace kaz::host
