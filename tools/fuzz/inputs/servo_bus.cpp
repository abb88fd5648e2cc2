// What a servo on a bus and its files get: bytes of a hostile host, and bus.json.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "hil/fuzz/choices.h"
#include "host/bus/bus_board.h"
#include "shared/feetech/bus_file.h"
#include "shared/feetech/packet.h"
#include "sim/bus/virtual_servo.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"

namespace kaz::fuzz {
namespace {

using hil::fuzz::Choices;
using Wire = std::vector<std::uint8_t>;

// A valid packet with fields as the input chooses, or raw bytes: checksums are hard to guess.
Wire next_bytes(Choices& choices) {
  if (choices.below(4) == 0) {
    Wire raw(choices.below(16));
    for (auto& byte : raw) byte = choices.byte();
    return raw;
  }
  feetech::Packet packet;
  packet.id = choices.below(8) == 0 ? choices.byte() : choices.below(2) == 0 ? 1 : 254;
  static constexpr std::uint8_t kCodes[] = {1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 0x82, 0x83};
  const unsigned which = choices.below(std::size(kCodes) + 1);
  packet.code = which < std::size(kCodes) ? kCodes[which] : choices.byte();
  packet.parameters.resize(choices.below(24));
  for (auto& byte : packet.parameters) byte = choices.byte();
  return feetech::wire_of(packet);
}

// Besides its range, a register may hold what the servo itself measures.
Complaint judge_registers(const sim::RegisterFile& registers) {
  for (const feetech::Register& reg : registers.model().registers) {
    const int value = registers.get(reg.name);
    if (value < reg.min || value > reg.max)
      return "register " + std::string(reg.name) + " is " + std::to_string(value);
  }
  return std::nullopt;
}

Complaint judge_answer(const sim::VirtualServo::Answer& answer) {
  feetech::PacketReader reader;
  int packets = 0;
  for (const std::uint8_t byte : answer.bytes)
    packets += reader.take(byte) == feetech::PacketReader::Event::packet ? 1 : 0;
  if (packets != 1 || reader.counts().bad() + reader.counts().skipped_bytes > 0)
    return "an answer is no packet";
  if (answer.delay < Time(0) || answer.delay > std::chrono::microseconds(508))
    return "an answer at no return delay";
  return std::nullopt;
}

}  // namespace

Complaint try_servo_bus(Bytes bytes) {
  Choices choices(bytes);
  const auto models = feetech::models();
  const feetech::Model& model = models[choices.below(static_cast<unsigned>(models.size()))];
  sim::VirtualServo servo(model, 1);
  sim::ServoReading reading{model.steps / 2.0, 0, 0, 25, 6.5};
  servo.set_power(true, reading);
  Time now{};
  while (!choices.ended()) {
    for (const std::uint8_t byte : next_bytes(choices)) {
      now += std::chrono::microseconds(10);
      if (const auto answer = servo.take(byte, now)) {
        if (auto wrong = judge_answer(*answer)) return wrong;
      }
    }
    if (servo.baud() < 38400 || servo.baud() > 1'000'000) return "a rate that is none";
    for (unsigned steps = choices.below(8); steps > 0; --steps) {
      now += std::chrono::milliseconds(1);
      const auto drive = servo.step(reading, 1e-3, now);
      if (!(std::abs(drive.duty) <= 1)) return "a duty that is none";
      reading.speed = drive.powered ? 5000 * drive.duty : 0;
      reading.steps += 1e-3 * reading.speed;
      reading.current_a = 2 * drive.duty;
    }
    if (auto wrong = judge_registers(servo.registers())) return wrong;
  }
  // Whatever was begun or restarted: after a second of silence it answers.
  now += std::chrono::seconds(1);
  const auto id = static_cast<std::uint8_t>(servo.registers().get("id"));
  bool answered = false;
  for (const auto byte : feetech::wire_of(feetech::request(id, feetech::Instruction::ping)))
    answered = servo.take(byte, now).has_value() || answered;
  return answered ? std::nullopt : Complaint("a ping is not answered");
}

namespace {

// What answers on the bus is what the fuzzer wants, for as long as there is any of it.
class HostileServos final : public host::Link, public host::Clock {
 public:
  explicit HostileServos(Bytes bytes) : bytes_(bytes) {}
  std::string name() const override { return "bus"; }
  Result<void> write(std::span<const std::uint8_t>) override {
    now_ += std::chrono::microseconds(100);
    requested_ = true;
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    // One length byte, and so many bytes; only what follows a request.
    const std::size_t wanted = requested_ && !bytes_.empty() ? bytes_[0] : 0u;
    requested_ = false;
    if (wanted == 0) {
      if (!bytes_.empty() && now_ < deadline) bytes_ = bytes_.subspan(1);
      now_ = std::max(now_, deadline);
      return std::size_t{0};
    }
    const std::size_t count = std::min({wanted, bytes_.size() - 1, bytes.size()});
    std::copy_n(bytes_.begin() + 1, count, bytes.begin());
    bytes_ = bytes_.subspan(1 + count);
    return count;
  }
  Time now() const override { return now_; }
  Result<void> sleep_until(Time t) override {
    now_ = std::max(now_, t);
    return {};
  }

 private:
  Bytes bytes_;
  bool requested_ = false;
  Time now_{1};
};

}  // namespace

Complaint try_bus_answers(Bytes bytes) {
  HostileServos servos(bytes);
  const feetech::Model* model = feetech::find_model("sts3215");
  auto board = host::BusBoard::open(servos, servos, {{{"a", 1, model, 2048, false}, -1, 1}});
  if (!board) return judge_error(board.error(), "bus", board.error().fault);
  const std::array<std::uint8_t, 3> query{1, KZ_TYPE_state, 1};
  for (std::uint8_t i = 0; i < 50; ++i) {
    auto body = query;
    body[2] = i;
    std::array<std::uint8_t, KZ_FRAME_MAX> wire{};
    const auto length = kz_frame_encode(body.data(), body.size(), wire.data());
    board->take(std::span(wire).first(length));
    const auto answer = board->serve();
    if (!answer || !*answer) return "a request for the state is not answered";
    kz_receiver receiver;
    kz_receiver_init(&receiver);
    bool whole = false;
    for (const std::uint8_t byte : **answer)
      whole = kz_receive(&receiver, byte, 0) == KZ_RECEIVE_FRAME || whole;
    kz_state_reply state{};
    if (!whole || !kz_unpack_state_reply(&state, receiver.body + KZ_HEADER_SIZE,
                                         static_cast<u8>(receiver.length - KZ_HEADER_SIZE)))
      return "an answer is no state";
    (void)servos.sleep_until(servos.now() + std::chrono::milliseconds(10));
  }
  return std::nullopt;
}

Complaint try_bus_file(Bytes bytes) {
  const auto file = feetech::parse_bus_file("bus.json", text_of(bytes));
  if (!file) return judge_error(file.error(), "bus.json");
  if (!(file->supply_volts >= 0 && file->supply_ohm >= 0) || file->servos.empty())
    return "a bus that is none";
  for (const feetech::BusServo& servo : file->servos) {
    if (servo.id < 0 || servo.id > feetech::kMaxId || servo.model == nullptr ||
        !std::isfinite(servo.steps_at(1)))
      return "a servo that is none";
  }
  return std::nullopt;
}

}  // namespace kaz::fuzz
