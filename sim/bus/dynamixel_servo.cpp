// A virtual DYNAMIXEL of the X series.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/dynamixel_servo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace kaz::sim {

using dynamixel::high;
using dynamixel::Instruction;
using dynamixel::low;
using dynamixel::Packet;
using dynamixel::PacketReader;
using servo_bus::Register;

namespace {

constexpr std::size_t kDxlPingAnswerBits = 140;
constexpr std::array<std::uint8_t, 5> kClearTurns{0x01, 0x44, 0x58, 0x4C, 0x22};
constexpr std::array<std::uint8_t, 5> kStore{0x01, 0x43, 0x54, 0x52, 0x4C};
constexpr std::array<std::uint8_t, 5> kRestore{0x02, 0x43, 0x54, 0x52, 0x4C};
constexpr int kWatchdogTripped = -1, kTickWraps = 32768;
constexpr Time kWatchdogUnit = std::chrono::milliseconds(20);

std::size_t number_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] + std::size_t{bytes[at + 1]} * 256;
}

// What a backup has of RAM.
bool backed_up_ram(const Register& reg) {
  return reg.name.ends_with("_gain") || reg.name.starts_with("profile_") ||
         reg.name.starts_with("indirect_address");
}

// One servo's part of a group read: how long its entry is, its id, what is read of it.
struct Entry {
  std::uint8_t id;
  std::size_t address, length;
};

// Empty: the parameters are none.
std::vector<Entry> entries_of(std::span<const std::uint8_t> parameters, bool bulk) {
  std::vector<Entry> entries;
  if (bulk) {
    if (parameters.size() % 5 != 0) return entries;
    for (std::size_t at = 0; at < parameters.size(); at += 5)
      entries.push_back(
          {parameters[at], number_at(parameters, at + 1), number_at(parameters, at + 3)});
  } else if (parameters.size() > 4) {
    for (const std::uint8_t id : parameters.subspan(4))
      entries.push_back({id, number_at(parameters, 0), number_at(parameters, 2)});
  }
  const auto too_long = [](const Entry& entry) {
    return entry.length == 0 || entry.length > dynamixel::kMaxLength - 8;
  };
  if (std::ranges::any_of(entries, too_long)) entries.clear();
  return entries;
}

}  // namespace

void DynamixelServo::restart() {
  motion_.power_on(registers_, reading_);
  protection_.power_on();
  reg_write_.reset();
  started_ = Time{-1};
  const int startup = registers_.get("startup_configuration");
  if ((startup & 2) != 0 && has_backup_) registers_.restore(backed_up_ram);
  registers_.set("backup_ready", has_backup_ ? 1 : 0);
  if ((startup & 1) != 0) switch_on();
}

void DynamixelServo::drop_packet() {
  reader_.reset();
  turn_.reset();
  fast_.reset();
  not_mine_ = 0;
}

MotorDrive DynamixelServo::drive(double step_s, Time now) {
  if (started_ < Time{0}) started_ = now;
  registers_.set("realtime_tick",
                 static_cast<int>((now - started_).count() / 1'000'000 % kTickWraps));
  const int watchdog = registers_.get("bus_watchdog");
  if (watchdog > 0 && registers_.get("torque_enable") != 0 &&
      now - last_request_ > watchdog * kWatchdogUnit)
    registers_.set("bus_watchdog", kWatchdogTripped);
  ServoReading measured = reading_;
  // The reading belongs to the last step, as the duty does.
  if (registers_.model().senses_supply_current) measured.current_a *= std::abs(motion_.duty());
  const MotorDrive drive = motion_.step(registers_, measured, step_s, watchdog_tripped());
  protection_.step(registers_, measured, motion_.duty(), step_s);
  return drive;
}

std::optional<VirtualServo::Answer> DynamixelServo::take(std::uint8_t byte, Time now) {
  if (!hears(now)) return std::nullopt;
  if (now - last_byte_ > kMaxGap) {
    if (reader_.inside()) reader_.reset();
    fast_.reset();
    not_mine_ = 0;
  }
  last_byte_ = now;
  if (not_mine_ > 0) {
    --not_mine_;
    return std::nullopt;
  }
  if (fast_) return continue_fast(byte);
  switch (reader_.take(byte)) {
    case PacketReader::Event::packet:
      return execute(reader_.packet(), now);
    case PacketReader::Event::bad_checksum: {
      const Packet& packet = reader_.packet();
      const bool mine = packet.id == registers_.get("id") && !packet.is_status();
      turn_.reset();
      return mine && registers_.get("status_return_level") == 2 ? status(Failure::crc)
                                                                : std::nullopt;
    }
    default:
      return std::nullopt;
  }
}

std::uint8_t DynamixelServo::error_byte(Failure failure) const {
  const bool alert = registers_.get("hardware_error_status") != 0;
  return static_cast<std::uint8_t>(static_cast<int>(failure) | (alert ? dynamixel::kAlert : 0));
}

Time DynamixelServo::return_delay() const {
  return Time(servo_bus::kReturnDelayUnitNs * registers_.get("return_delay_time"));
}

std::optional<VirtualServo::Answer> DynamixelServo::status(
    Failure failure, std::vector<std::uint8_t> parameters) const {
  const Packet packet{static_cast<std::uint8_t>(registers_.get("id")),
                      static_cast<std::uint8_t>(Instruction::status), error_byte(failure),
                      std::move(parameters)};
  return Answer{dynamixel::wire_of(packet), return_delay()};
}

std::optional<VirtualServo::Answer> DynamixelServo::execute(const Packet& packet, Time now) {
  const int id = registers_.get("id");
  if (packet.is_status()) {
    if (!turn_ || packet.id != turn_->after) return std::nullopt;
    const Block block = turn_->block;
    turn_.reset();
    return read(block);
  }
  turn_.reset();
  last_request_ = now;
  const int secondary_id = registers_.get("secondary_id");
  const bool broadcast = packet.id == dynamixel::kBroadcast;
  const bool secondary =
      packet.id != id && packet.id == secondary_id && secondary_id <= dynamixel::kMaxId;
  if (packet.id != id && !broadcast && !secondary) return std::nullopt;
  const Bytes parameters = packet.parameters;
  const auto instruction = static_cast<Instruction>(packet.instruction);
  // EEPROM is out of its reach, so nothing else than these.
  if (secondary && instruction != Instruction::write && instruction != Instruction::reg_write &&
      instruction != Instruction::action)
    return std::nullopt;
  const bool silent = broadcast || secondary || registers_.get("status_return_level") < 2;
  // Composed before anything changes: the id and the alert are those of the request.
  std::array<std::optional<Answer>, 8> answers;
  for (std::size_t i = 0; i < answers.size() && !silent; ++i)
    answers[i] = status(static_cast<Failure>(i));
  const auto done = [&](Failure failure) {
    ++executed_;
    return answers[static_cast<std::size_t>(failure)];
  };
  switch (instruction) {
    case Instruction::ping:
      if (!parameters.empty()) return std::nullopt;
      ++executed_;
      return ping(broadcast);
    case Instruction::read:
      if (broadcast || !answers_reads()) return std::nullopt;
      if (parameters.size() != 4) return done(Failure::instruction);
      ++executed_;
      return read({number_at(parameters, 0), number_at(parameters, 2)});
    case Instruction::write:
      if (parameters.size() < 3) return done(Failure::instruction);
      return done(write(number_at(parameters, 0), parameters.subspan(2), secondary));
    case Instruction::reg_write: {
      if (parameters.size() < 3) return done(Failure::instruction);
      std::vector<Item> items;
      const Bytes data = parameters.subspan(2);
      const Failure failure = items_of(number_at(parameters, 0), data, items);
      if (failure != Failure::none) return done(failure);
      reg_write_ = {number_at(parameters, 0), {data.begin(), data.end()}, secondary};
      registers_.set("registered_instruction", 1);
      return done(Failure::none);
    }
    case Instruction::action:
      return done(action());
    case Instruction::factory_reset:
      return done(reset_to_factory(parameters, broadcast, now));
    case Instruction::reboot:
      restart_until(now + kReboot);
      return done(Failure::none);
    case Instruction::clear:
      return done(clear(parameters));
    case Instruction::backup:
      return done(keep_or_restore(parameters, now));
    case Instruction::sync_read:
    case Instruction::bulk_read:
      return broadcast ? group_read(parameters, instruction == Instruction::bulk_read)
                       : done(Failure::instruction);
    case Instruction::fast_sync_read:
    case Instruction::fast_bulk_read:
      return broadcast ? fast_read(parameters, instruction == Instruction::fast_bulk_read)
                       : done(Failure::instruction);
    case Instruction::sync_write:
    case Instruction::bulk_write:
      if (!broadcast) return done(Failure::instruction);
      group_write(parameters, instruction == Instruction::bulk_write);
      return std::nullopt;
    case Instruction::status:
      break;
  }
  return done(Failure::instruction);
}

std::optional<VirtualServo::Answer> DynamixelServo::ping(bool broadcast) const {
  const auto number = static_cast<std::size_t>(registers_.get("model_number"));
  auto answer = status(
      Failure::none,
      {low(number), high(number), static_cast<std::uint8_t>(registers_.get("firmware_version"))});
  if (broadcast) answer->delay += ping_turn(registers_.get("id"), kDxlPingAnswerBits);
  return answer;
}

// Through the indirect registers, once.
std::size_t DynamixelServo::target_of(std::size_t address) const {
  static constexpr std::pair<const char*, const char*> kRows[] = {
      {"indirect_data", "indirect_address"}, {"indirect_data_29", "indirect_address_29"}};
  for (const auto& [data, addresses] : kRows) {
    const Register* reg = registers_.model().find(data);
    if (reg == nullptr || address < reg->address || address >= static_cast<std::size_t>(reg->end()))
      continue;
    const Register& row = *registers_.model().find(addresses);
    return static_cast<std::size_t>(registers_.get(row, static_cast<int>(address) - reg->address));
  }
  return address;
}

std::vector<std::uint8_t> DynamixelServo::bytes_at(Block block) const {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < block.length; ++i)
    bytes.push_back(registers_.read(target_of(block.address + i), 1)[0]);
  return bytes;
}

std::optional<VirtualServo::Answer> DynamixelServo::read(Block block) const {
  const servo_bus::Model& model = registers_.model();
  bool any = false;
  for (std::size_t i = 0; i < block.length && block.address + i < model.end() && !any; ++i)
    any = model.at(block.address + i) != nullptr;
  if (!any || block.length > dynamixel::kMaxLength - 8) return status(Failure::access);
  return status(Failure::none, bytes_at(block));
}

std::optional<VirtualServo::Answer> DynamixelServo::group_read(Bytes parameters, bool bulk) {
  const auto entries = entries_of(parameters, bulk);
  const auto mine = std::ranges::find(entries, registers_.get("id"), &Entry::id);
  if (mine == entries.end() || !answers_reads()) return std::nullopt;
  ++executed_;
  const Block block{mine->address, mine->length};
  if (mine == entries.begin()) return read(block);
  turn_ = {(mine - 1)->id, block};
  return std::nullopt;
}

std::optional<VirtualServo::Answer> DynamixelServo::fast_read(Bytes parameters, bool bulk) {
  const auto entries = entries_of(parameters, bulk);
  const auto mine = std::ranges::find(entries, registers_.get("id"), &Entry::id);
  if (mine == entries.end() || !answers_reads()) return std::nullopt;
  ++executed_;
  std::size_t before = 0, behind = 0;
  for (auto entry = entries.begin(); entry != entries.end(); ++entry) {
    if (entry != mine) (entry < mine ? before : behind) += dynamixel::kFastFrame + entry->length;
  }
  fast_ = {{}, dynamixel::kFastHead + before, behind, {mine->address, mine->length}};
  if (mine != entries.begin()) return std::nullopt;
  const std::size_t length = 1 + dynamixel::kFastFrame + mine->length + behind;
  for (const int byte :
       {0xFF, 0xFF, 0xFD, 0x00, int{dynamixel::kBroadcast}, int{low(length)}, int{high(length)}})
    fast_->heard.push_back(static_cast<std::uint8_t>(byte));
  const auto head = fast_->heard;
  auto answer = continue_fast(static_cast<std::uint8_t>(Instruction::status));
  answer->bytes.insert(answer->bytes.begin(), head.begin(), head.end());
  answer->bytes.insert(answer->bytes.begin() + static_cast<std::ptrdiff_t>(head.size()),
                       static_cast<std::uint8_t>(Instruction::status));
  answer->delay = return_delay();
  return answer;
}

// A byte of the joined answer; this servo's part once all before it has come.
std::optional<VirtualServo::Answer> DynamixelServo::continue_fast(std::uint8_t byte) {
  auto& heard = fast_->heard;
  heard.push_back(byte);
  if (heard.size() == dynamixel::kFastHead &&
      (heard[4] != dynamixel::kBroadcast ||
       byte != static_cast<std::uint8_t>(Instruction::status))) {
    // Something else passes over the wire.
    const auto other = std::move(heard);
    fast_.reset();
    for (const std::uint8_t one : other) (void)reader_.take(one);
    return std::nullopt;
  }
  if (heard.size() < fast_->before) return std::nullopt;
  std::vector<std::uint8_t> part{error_byte(Failure::none),
                                 static_cast<std::uint8_t>(registers_.get("id"))};
  std::ranges::copy(bytes_at(fast_->block), std::back_inserter(part));
  const std::uint16_t crc = dynamixel::crc16(part, dynamixel::crc16(heard));
  part.insert(part.end(), {low(crc), high(crc)});
  not_mine_ = fast_->behind;
  fast_.reset();
  return Answer{std::move(part), Time{0}};
}

void DynamixelServo::group_write(Bytes parameters, bool bulk) {
  const int id = registers_.get("id"), other = registers_.get("secondary_id");
  std::size_t address = 0, length = 0;
  Bytes left = parameters;
  if (!bulk) {
    if (left.size() < 4) return;
    address = number_at(left, 0);
    length = number_at(left, 2);
    left = left.subspan(4);
  }
  while (!left.empty()) {
    const std::uint8_t to = left[0];
    left = left.subspan(1);
    if (bulk) {
      if (left.size() < 4) return;
      address = number_at(left, 0);
      length = number_at(left, 2);
      left = left.subspan(4);
    }
    if (length == 0 || left.size() < length) return;
    const bool secondary = to != id && to == other && other <= dynamixel::kMaxId;
    if (to == id || secondary) {
      ++executed_;
      (void)write(address, left.first(length), secondary);
    }
    left = left.subspan(length);
  }
}

DynamixelServo::Failure DynamixelServo::action() {
  const auto waiting = std::exchange(reg_write_, std::nullopt);
  registers_.set("registered_instruction", 0);
  return waiting ? write(waiting->address, waiting->bytes, waiting->secondary)
                 : Failure::instruction;
}

DynamixelServo::Failure DynamixelServo::reset_to_factory(Bytes parameters, bool broadcast,
                                                         Time now) {
  if (parameters.size() != 1) return Failure::instruction;
  const std::uint8_t option = parameters[0];
  if (option != 0xFF && option != 1 && option != 2) return Failure::range;
  if (option == 0xFF && broadcast) return Failure::result;
  registers_.reset([option](const Register& reg) {
    const bool stays =
        (option != 0xFF && reg.name == "id") || (option == 2 && reg.name == "baud_rate");
    return reg.eeprom && !stays;
  });
  restart_until(now + kReboot);
  return Failure::none;
}

DynamixelServo::Failure DynamixelServo::clear(Bytes parameters) {
  if (!std::ranges::equal(parameters, kClearTurns)) return Failure::range;
  return motion_.clear_turns(registers_) ? Failure::none : Failure::result;
}

DynamixelServo::Failure DynamixelServo::keep_or_restore(Bytes parameters, Time now) {
  const bool restores = std::ranges::equal(parameters, kRestore);
  if (!restores && !std::ranges::equal(parameters, kStore)) return Failure::range;
  if (registers_.get("torque_enable") != 0 || (restores && !has_backup_)) return Failure::result;
  if (restores) {
    registers_.restore([](const Register& reg) { return reg.eeprom; });
    restart_until(now + kReboot);
  } else {
    registers_.backup();
    has_backup_ = true;
    registers_.set("backup_ready", 1);
  }
  return Failure::none;
}

DynamixelServo::Failure DynamixelServo::refuses(const Item& item) const {
  const Register& reg = *item.reg;
  if (!reg.writable) return Failure::access;
  if (reg.eeprom && registers_.get("torque_enable") != 0) return Failure::access;
  if (!reg.allows(item.value)) return Failure::range;
  const bool goal = reg.name.starts_with("goal_");
  if (goal && watchdog_tripped()) return Failure::range;
  const auto beyond = [&](const char* limit) {
    return std::abs(item.value) > registers_.get(limit);
  };
  if ((reg.name == "goal_pwm" && beyond("pwm_limit")) ||
      (reg.name == "goal_current" && beyond("current_limit")) ||
      (reg.name == "goal_velocity" && beyond("velocity_limit")))
    return Failure::limit;
  const bool one_turn = registers_.get("operating_mode") == 3;
  if (reg.name == "goal_position" && one_turn &&
      (item.value < registers_.get("min_position_limit") ||
       item.value > registers_.get("max_position_limit")))
    return Failure::limit;
  if (reg.name == "torque_enable" && item.value != 0 && protection_.shut_down())
    return Failure::result;
  return Failure::none;
}

// The registers that the bytes are written to, or what stands against it.
DynamixelServo::Failure DynamixelServo::items_of(std::size_t address, Bytes bytes,
                                                 std::vector<Item>& items) const {
  for (std::size_t i = 0; i < bytes.size();) {
    const std::size_t begin = target_of(address + i);
    const Register* reg = registers_.model().at(begin);
    if (reg == nullptr) return Failure::access;
    if (!reg->writable) return Failure::access;
    const std::size_t place = begin - reg->address;
    bool whole = place % reg->size == 0 && i + reg->size <= bytes.size();
    for (std::size_t k = 1; k < reg->size && whole; ++k)
      whole = target_of(address + i + k) == begin + k;
    if (!whole) return Failure::length;
    const Item item{reg, static_cast<int>(place / reg->size),
                    servo_bus::decode(registers_.model(), *reg, bytes.subspan(i))};
    const Failure failure = refuses(item);
    if (failure != Failure::none) return failure;
    items.push_back(item);
    i += reg->size;
  }
  return Failure::none;
}

DynamixelServo::Failure DynamixelServo::write(std::size_t address, Bytes bytes, bool secondary) {
  std::vector<Item> items;
  const Failure failure = items_of(address, bytes, items);
  if (failure != Failure::none) return failure;
  if (secondary && std::ranges::any_of(items, [](const Item& item) { return item.reg->eeprom; }))
    return Failure::access;
  for (const Item& item : items) apply(item);
  return Failure::none;
}

void DynamixelServo::apply(const Item& item) {
  const Register& reg = *item.reg;
  const bool changes = registers_.get(reg, item.index) != item.value;
  registers_.write(reg, item.index, item.value);
  if (reg.name == "operating_mode" && changes) motion_.mode_written(registers_);
  if (reg.name == "torque_enable" && changes && item.value != 0) switch_on();
  if (!reg.name.starts_with("goal_")) return;
  const bool starts = (registers_.get("drive_mode") & 8) != 0 && !protection_.shut_down() &&
                      registers_.get("torque_enable") == 0;
  if (starts) {
    switch_on();
    registers_.set(reg.name, item.value);
  }
  motion_.goal_written(registers_);
}

void DynamixelServo::switch_on() {
  registers_.set("torque_enable", 1);
  motion_.switch_on(registers_);
}

}  // namespace kaz::sim
