// The servo board on a motor stand: steps, and the serial line.
// SPDX-License-Identifier: Apache-2.0
#include "tools/board_page/session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "shared/protocol/messages.h"

namespace kaz::board_page {
namespace {

// Bytes without a zero are no frame: shown in pieces of this length.
constexpr std::size_t kMaxPiece = 256;

sim::ServoBoardOptions board_options(const SessionOptions& options) {
  sim::ServoBoardOptions board;
  board.params = options.sensors;
  board.supply_ohms = 0.02;  // the stand's laboratory supply (sim/stand/stand_commands.cpp)
  if (!options.noise) board.sensors = sim::SensorSwitches::ideal();
  return board;
}

}  // namespace

Result<std::unique_ptr<Session>> Session::begin(const std::string& image_path,
                                                const SessionOptions& options) {
  h8s::Options chip;
  chip.engine = options.engine;
  auto mcu = KAZ_TRY(sim::H8Mcu::load(image_path, chip));
  return std::unique_ptr<Session>(new Session(std::move(mcu), options));
}

Session::Session(std::unique_ptr<sim::H8Mcu> mcu, const SessionOptions& options)
    : mcu_(mcu.get()),
      board_(std::move(mcu), board_options(options)),
      stand_({.motor = options.motor}) {
  kz_receiver_init(&receiver_);
  set_sensors();
}

void Session::set_sensors() {
  std::array<double, KZ_JOINTS> angles{};
  double motor_current = 0;
  const auto joints = stand_.joints();
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    angles[j] = joints[j].angle;
    motor_current += std::abs(joints[j].current);
  }
  board_.set_joint_angles(angles);
  board_.set_supply_current(stand_.supply_current_a());
  board_.set_motor_current(motor_current);
}

void Session::move_shafts() {
  std::array<sim::MotorDrive, KZ_JOINTS> drives{};
  const auto means = board_.take_drives();
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    drives[j].duty = means[j].duty;
    drives[j].powered = means[j].powered;
  }
  stand_.step(drives, board_.supply_volts());
}

Result<void> Session::step() {
  if (keep_alive_ms_ > 0 && --keep_alive_left_ <= 0) {
    keep_alive_left_ = keep_alive_ms_;
    const std::array<std::uint8_t, 2> unchanged{};
    send(KZ_ADDRESS_ALL, KZ_TYPE_heartbeat, unchanged);
  }
  const sim::States end = now_ + KZ_STATES_PER_TICK;
  for (const sim::SerialByte& byte : line_.take_for_board(end)) board_.receive(byte);
  const auto ran = board_.run_until(end);
  move_shafts();
  set_sensors();
  line_.from_board(board_.take_transmitted());
  now_ = end;
  read_line();
  return ran;
}

void Session::read_line() {
  std::array<std::uint8_t, 64> bytes{};
  const std::size_t count = line_.read(bytes, now_);
  if (count == 0) {
    const std::uint8_t result = kz_receiver_silent(&receiver_);
    if (result == KZ_RECEIVE_MORE) return;
    add({false, now_, std::exchange(incoming_, {}), result, {}});
    return;
  }
  receiver_.silent_ms = 0;
  for (std::size_t i = 0; i < count; ++i) {
    incoming_.push_back(bytes[i]);
    const std::uint8_t result = kz_receive(&receiver_, bytes[i], 0);
    if (result == KZ_RECEIVE_MORE && incoming_.size() < kMaxPiece) continue;
    LineEntry entry{false, now_, std::exchange(incoming_, {}), result, {}};
    if (result == KZ_RECEIVE_FRAME)
      entry.body.assign(receiver_.body, receiver_.body + receiver_.length);
    add(std::move(entry));
  }
}

void Session::add(LineEntry entry) {
  if (entries_.size() == max_entries) {
    entries_.erase(entries_.begin(), entries_.begin() + max_entries / 2);
    dropped_ += max_entries / 2;
  }
  entries_.push_back(std::move(entry));
}

std::vector<LineEntry> Session::take_line() {
  return std::exchange(entries_, {});
}

// A sequence number for which no damage to one byte leaves a valid frame (kz_frame_splits), as hosts do.
Session::Framed Session::framed(std::uint8_t address, std::uint8_t type,
                                std::span<const std::uint8_t> fields) const {
  std::array<std::uint8_t, KZ_BODY_MAX> body{};
  const std::size_t size = std::min<std::size_t>(fields.size(), KZ_PAYLOAD_MAX);
  body[KZ_BODY_ADDRESS] = address;
  body[KZ_BODY_TYPE] = type;
  std::copy_n(fields.begin(), size, body.begin() + KZ_HEADER_SIZE);
  std::array<std::uint8_t, KZ_FRAME_MAX> wire{};
  std::uint8_t length = 0, sequence = sequence_;
  for (int attempt = 0; attempt < 8; ++attempt) {
    ++sequence;
    body[KZ_BODY_SEQUENCE] = sequence;
    length =
        kz_frame_encode(body.data(), static_cast<std::uint8_t>(KZ_HEADER_SIZE + size), wire.data());
    if (!kz_frame_splits(wire.data(), length)) break;
  }
  return {{wire.begin(), wire.begin() + length}, sequence};
}

std::vector<std::uint8_t> Session::preview(std::uint8_t address, std::uint8_t type,
                                           std::span<const std::uint8_t> fields) const {
  return framed(address, type, fields).wire;
}

std::uint8_t Session::send(std::uint8_t address, std::uint8_t type,
                           std::span<const std::uint8_t> fields) {
  const Framed frame = framed(address, type, fields);
  sequence_ = frame.sequence;
  send_raw(frame.wire);
  return sequence_;
}

void Session::send_raw(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  line_.write(bytes, now_);
  LineEntry entry{true, now_, {bytes.begin(), bytes.end()}, KZ_RECEIVE_MORE, {}};
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  for (const std::uint8_t byte : bytes) {
    entry.result = kz_receive(&receiver, byte, 0);
    if (entry.result == KZ_RECEIVE_MORE) continue;
    if (entry.result == KZ_RECEIVE_FRAME)
      entry.body.assign(receiver.body, receiver.body + receiver.length);
    break;
  }
  add(std::move(entry));
}

void Session::keep_alive(int period_ms) {
  keep_alive_ms_ = std::max(0, period_ms);
  keep_alive_left_ = 0;
}

void Session::turn(std::size_t joint, double angle_rad) {
  hands_[joint] = angle_rad;
  stand_.turn(joint, angle_rad);
}

void Session::release(std::size_t joint) {
  hands_[joint].reset();
  stand_.release(joint);
}

}  // namespace kaz::board_page
