// Asks servos, and waits for what they answer.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/bus_client.h"

#include <algorithm>
#include <array>

namespace kaz::host {

using feetech::BusServo;
using feetech::Instruction;
using feetech::Packet;
using feetech::PacketReader;

namespace {

constexpr int kTries = 2;

std::uint8_t id_of(const BusServo& servo) {
  return static_cast<std::uint8_t>(servo.id);
}

}  // namespace

// What came before belongs to no request any more.
Result<void> BusClient::send(const Packet& request) {
  std::array<std::uint8_t, 256> old{};
  while (KAZ_TRY(link_.read(old, clock_.now())) > 0) {
  }
  come_.clear();
  reader_.reset();
  ++counts_.requests;
  return link_.write(feetech::wire_of(request));
}

// Nothing: it did not come in time, or damaged. An adapter may hand back the request itself.
Result<BusClient::Answer> BusClient::receive(std::uint8_t id, std::size_t parameters,
                                             const Packet& request) {
  const Time deadline = clock_.now() + kAnswerWithin;
  std::array<std::uint8_t, 256> bytes{};
  while (true) {
    for (std::size_t i = 0; i < come_.size(); ++i) {
      const auto event = reader_.take(come_[i]);
      if (event == PacketReader::Event::none) continue;
      if (event != PacketReader::Event::packet) {
        come_.clear();
        ++counts_.damaged;
        return Answer();
      }
      const Packet packet = reader_.packet();
      if (packet == request) continue;
      come_.erase(come_.begin(), come_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      if (packet.id == id && packet.parameters.size() == parameters) return Answer(packet);
      ++counts_.damaged;
      return Answer();
    }
    come_.clear();
    if (clock_.now() >= deadline) return Answer();
    const std::size_t count = KAZ_TRY(link_.read(bytes, deadline));
    come_.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
  }
}

Result<BusClient::Answer> BusClient::query(const Packet& request, std::size_t parameters) {
  for (int i = 0; i < kTries; ++i) {
    KAZ_TRY(send(request));
    auto answer = KAZ_TRY(receive(request.id, parameters, request));
    if (answer) return answer;
  }
  ++counts_.missing;
  return Answer();
}

Result<bool> BusClient::ping(const BusServo& servo) {
  return KAZ_TRY(query(feetech::request(id_of(servo), Instruction::ping), 0)).has_value();
}

Result<std::optional<int>> BusClient::read(const BusServo& servo, std::string_view name) {
  const feetech::Register& reg = *servo.model->find(name);
  const auto answer = KAZ_TRY(
      query(feetech::request(id_of(servo), Instruction::read, {reg.address, reg.size}), reg.size));
  if (!answer) return std::optional<int>();
  return std::optional<int>(feetech::decode(*servo.model, reg, answer->parameters));
}

Result<bool> BusClient::write(const BusServo& servo, std::string_view name, int value) {
  const feetech::Register& reg = *servo.model->find(name);
  std::vector<std::uint8_t> parameters{reg.address};
  std::ranges::copy(feetech::encode(*servo.model, reg, value), std::back_inserter(parameters));
  return KAZ_TRY(
             query(feetech::request(id_of(servo), Instruction::write, std::move(parameters)), 0))
      .has_value();
}

Result<std::vector<BusClient::Answer>> BusClient::read_all(Servos servos, std::uint8_t address,
                                                           std::uint8_t count) {
  std::vector<Answer> answers(servos.size());
  const bool together =
      std::ranges::all_of(servos, [](const BusServo* servo) { return servo->model->sync_read; });
  if (together && !servos.empty()) {
    std::vector<std::uint8_t> parameters{address, count};
    for (const BusServo* servo : servos) parameters.push_back(id_of(*servo));
    const Packet all = feetech::request(feetech::kBroadcast, Instruction::sync_read, parameters);
    KAZ_TRY(send(all));
    for (std::size_t i = 0; i < servos.size(); ++i) {
      answers[i] = KAZ_TRY(receive(id_of(*servos[i]), count, all));
      // Those behind it may be silent, too: they are asked one by one.
      if (!answers[i]) break;
    }
  }
  for (std::size_t i = 0; i < servos.size(); ++i) {
    if (!answers[i])
      answers[i] = KAZ_TRY(
          query(feetech::request(id_of(*servos[i]), Instruction::read, {address, count}), count));
  }
  return answers;
}

Result<void> BusClient::write_all(Servos servos, std::uint8_t address,
                                  std::span<const std::vector<std::uint8_t>> data) {
  if (servos.empty()) return {};
  std::vector<std::uint8_t> parameters{address, static_cast<std::uint8_t>(data.front().size())};
  for (std::size_t i = 0; i < servos.size(); ++i) {
    parameters.push_back(id_of(*servos[i]));
    std::ranges::copy(data[i], std::back_inserter(parameters));
  }
  return send(
      feetech::request(feetech::kBroadcast, Instruction::sync_write, std::move(parameters)));
}

}  // namespace kaz::host
