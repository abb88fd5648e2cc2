// A virtual servo of Feetech's.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/feetech_servo.h"

#include <algorithm>
#include <utility>

namespace kaz::sim {

using feetech::Instruction;
using feetech::Packet;
using feetech::PacketReader;
using servo_bus::Register;

namespace {
constexpr int kMiddle = 2048;            // of position calibration
constexpr int kCalibratePosition = 128;  // written to torque_enable
// Bits of `phase`.
constexpr int kDriveReversed = 1, kFeedbackReversed = 128;
constexpr std::size_t kStsPingAnswerBits = 60;
}  // namespace

bool FeetechServo::phase_has(int bit) const {
  return registers_.model().full_turn && (registers_.get("phase") & bit) != 0;
}

ServoReading FeetechServo::sensed() const {
  ServoReading sensed = reading_;
  if (phase_has(kFeedbackReversed)) {
    sensed.steps = registers_.model().steps - 1 - reading_.steps;
    sensed.speed = -reading_.speed;
  }
  return sensed;
}

void FeetechServo::restart() {
  registers_.set("torque_limit", registers_.get("max_torque"));
  motion_.power_on(sensed());
  motion_.reset_turns(registers_.model());
  protection_.power_on();
  reg_write_.reset();
  turn_.reset();
}

MotorDrive FeetechServo::drive(double step_s, Time) {
  const double limit = protection_.limit(registers_);
  MotorDrive drive = motion_.step(registers_, sensed(), limit, step_s);
  // Current and speed in the direction of a positive duty.
  const double direction = phase_has(kDriveReversed) ? -1 : 1;
  ServoReading driven = reading_;
  driven.current_a *= direction;
  driven.speed *= direction;
  protection_.step(registers_, driven, motion_.duty(), step_s);
  drive.duty *= direction;
  return drive;
}

std::optional<VirtualServo::Answer> FeetechServo::take(std::uint8_t byte, Time now) {
  if (!hears(now)) return std::nullopt;
  if (reader_.inside() && now - last_byte_ > kMaxGap) reader_.reset();
  last_byte_ = now;
  if (reader_.take(byte) != PacketReader::Event::packet) return std::nullopt;
  return execute(reader_.packet(), now);
}

// Null: this model does not answer it at all, at its response level.
std::optional<VirtualServo::Answer> FeetechServo::answer(
    std::vector<std::uint8_t> parameters) const {
  const Packet packet{static_cast<std::uint8_t>(registers_.get("id")),
                      static_cast<std::uint8_t>(registers_.get("status")), std::move(parameters)};
  return Answer{feetech::wire_of(packet),
                Time(servo_bus::kReturnDelayUnitNs * registers_.get("return_delay"))};
}

std::optional<VirtualServo::Answer> FeetechServo::execute(const Packet& packet, Time now) {
  const int id = registers_.get("id");
  const bool broadcast = packet.id == feetech::kBroadcast;
  if (packet.id != id && !broadcast) {
    if (!turn_ || packet.id != turn_->after) return std::nullopt;
    const Turn turn = *turn_;
    turn_.reset();
    return answer(registers_.read(turn.address, turn.length));
  }
  turn_.reset();
  const Bytes parameters = packet.parameters;
  const auto instruction = static_cast<Instruction>(packet.code);
  const servo_bus::Model& model = registers_.model();
  const bool answers_all = registers_.get("response_level") != 0 && !broadcast;
  // Composed before anything changes: the id and the rate are those of the request.
  const auto done = answers_all ? answer() : std::nullopt;
  switch (instruction) {
    case Instruction::ping:
      if (!parameters.empty()) return std::nullopt;
      ++executed_;
      return ping(broadcast);
    case Instruction::read:
      if (broadcast || parameters.size() != 2) return std::nullopt;
      ++executed_;
      if (parameters[1] > feetech::kMaxParameters) return std::nullopt;
      return answer(registers_.read(parameters[0], parameters[1]));
    case Instruction::write:
      if (parameters.size() < 2) return std::nullopt;
      ++executed_;
      write(parameters[0], parameters.subspan(1));
      return done;
    case Instruction::reg_write:
      if (parameters.size() < 2) return std::nullopt;
      ++executed_;
      reg_write_ = {parameters[0], {parameters.begin() + 1, parameters.end()}};
      registers_.set("async_write", 1);
      return done;
    case Instruction::action:
      ++executed_;
      if (const auto waiting = std::exchange(reg_write_, std::nullopt))
        write(waiting->address, waiting->bytes);
      registers_.set("async_write", 0);
      return done;
    case Instruction::restore:
      ++executed_;
      if (!registers_.locked())
        registers_.restore([](const Register& reg) { return reg.eeprom && reg.name != "id"; });
      return done;
    case Instruction::backup:
      ++executed_;
      if (!registers_.locked()) registers_.backup();
      return done;
    case Instruction::restart:
      ++executed_;
      restart_until(now + kRestart);
      return std::nullopt;
    case Instruction::reset_turns:
      if (!model.full_turn) return std::nullopt;
      ++executed_;
      motion_.reset_turns(model);
      return done;
    case Instruction::set_middle: {
      if (!model.full_turn || (parameters.size() != 0 && parameters.size() != 2))
        return std::nullopt;
      ++executed_;
      const Register& goal = *model.find("goal_position");
      motion_.set_position(
          registers_, parameters.empty() ? kMiddle : servo_bus::decode(model, goal, parameters));
      return done;
    }
    case Instruction::sync_read:
      return broadcast && model.sync_read ? sync_read(parameters) : std::nullopt;
    case Instruction::sync_write:
      if (broadcast) sync_write(parameters);
      return std::nullopt;
  }
  return std::nullopt;
}

std::optional<VirtualServo::Answer> FeetechServo::ping(bool broadcast) const {
  auto pinged = answer();
  if (broadcast && broadcast_ping_in_turn_)
    pinged->delay += ping_turn(registers_.get("id"), kStsPingAnswerBits);
  return pinged;
}

// Address, length, ids.
std::optional<VirtualServo::Answer> FeetechServo::sync_read(Bytes parameters) {
  if (parameters.size() < 3 || parameters[1] > feetech::kMaxParameters) return std::nullopt;
  const Bytes ids = parameters.subspan(2);
  const auto mine = std::ranges::find(ids, registers_.get("id"));
  if (mine == ids.end()) return std::nullopt;
  ++executed_;
  if (mine == ids.begin()) return answer(registers_.read(parameters[0], parameters[1]));
  turn_ = {*(mine - 1), parameters[0], parameters[1]};
  return std::nullopt;
}

// Address, length, then id and data of each servo.
void FeetechServo::sync_write(Bytes parameters) {
  if (parameters.size() < 2) return;
  const std::uint8_t address = parameters[0];
  const std::size_t length = parameters[1];
  Bytes left = parameters.subspan(2);
  if (length == 0 || left.size() % (length + 1) != 0) return;
  for (; !left.empty(); left = left.subspan(length + 1)) {
    if (left[0] != registers_.get("id")) continue;
    ++executed_;
    write(address, left.subspan(1, length));
    return;
  }
}

void FeetechServo::write(std::uint8_t address, Bytes bytes) {
  const int torque = registers_.get("torque_enable");
  const auto written = registers_.write(address, bytes);
  const auto has = [&](std::string_view name) {
    return std::ranges::any_of(written, [&](const Register* reg) { return reg->name == name; });
  };
  if (has("torque_enable") && registers_.get("torque_enable") == kCalibratePosition) {
    registers_.set("torque_enable", torque);
    motion_.set_position(registers_, kMiddle);
  }
  if (has(motion_.goal_register(registers_))) protection_.goal_written();
  if (!has("goal_position")) return;
  // Concluded from clients that never write torque_enable, whose initial value is 0: Feetech's own example
  // WritePos (ftservo/FTServo_Linux), @lerobot/web.
  registers_.set("torque_enable", 1);
  motion_.goal_written(registers_);
}

}  // namespace kaz::sim
