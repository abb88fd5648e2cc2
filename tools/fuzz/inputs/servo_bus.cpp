// What a servo on a bus and its files get: bytes of a hostile host, and bus.json.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "hil/bus/bus_suite.h"
#include "hil/fuzz/choices.h"
#include "host/bus/bus_board.h"
#include "host/bus/bus_scan.h"
#include "shared/dynamixel/packet.h"
#include "shared/feetech/packet.h"
#include "shared/servo_bus/bus_file.h"
#include "sim/bus/virtual_servo.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"

namespace kaz::fuzz {
namespace {

using hil::fuzz::Choices;
using Wire = std::vector<std::uint8_t>;

Wire raw_bytes(Choices& choices) {
  Wire raw(choices.below(16));
  for (auto& byte : raw) byte = choices.byte();
  return raw;
}

std::uint8_t next_id(Choices& choices) {
  return choices.below(8) == 0 ? choices.byte() : choices.below(2) == 0 ? 1 : 254;
}

Wire next_parameters(Choices& choices) {
  Wire parameters(choices.below(24));
  for (auto& byte : parameters) byte = choices.byte();
  return parameters;
}

std::uint8_t next_code(Choices& choices, std::span<const std::uint8_t> codes) {
  const unsigned which = choices.below(static_cast<unsigned>(codes.size()) + 1);
  return which < codes.size() ? codes[which] : choices.byte();
}

// A valid packet with fields as the input chooses, or raw bytes: checksums are hard to guess.
Wire next_bytes(Choices& choices, servo_bus::Protocol protocol) {
  if (choices.below(4) == 0) return raw_bytes(choices);
  const std::uint8_t id = next_id(choices);
  if (protocol == servo_bus::Protocol::feetech) {
    static constexpr std::uint8_t kCodes[] = {1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 0x82, 0x83};
    const std::uint8_t code = next_code(choices, kCodes);
    return feetech::wire_of({id, code, next_parameters(choices)});
  }
  static constexpr std::uint8_t kCodes[] = {1,    2,    3,    4,    5,    6,    8,    0x10,
                                            0x20, 0x55, 0x82, 0x83, 0x8A, 0x92, 0x93, 0x9A};
  const std::uint8_t code = next_code(choices, kCodes);
  return dynamixel::wire_of({id, code, 0, next_parameters(choices)});
}

// Besides its range, a register may hold what the servo itself measures, or that its watchdog has tripped.
Complaint judge_registers(const sim::RegisterFile& registers) {
  for (const servo_bus::Register& reg : registers.model().registers) {
    for (int i = 0; i < reg.count; ++i) {
      const int value = registers.get(reg, i);
      const bool tripped = reg.name == "bus_watchdog" && value == -1;
      if ((value < reg.min || value > reg.max) && !tripped)
        return "register " + std::string(reg.name) + " is " + std::to_string(value);
    }
  }
  return std::nullopt;
}

// `part`: it may be one of the parts that servos put together to a packet.
template <class Reader>
Complaint judge_answer(const sim::VirtualServo::Answer& answer, bool part, Time most) {
  Reader reader;
  int packets = 0;
  for (const std::uint8_t byte : answer.bytes)
    packets += reader.take(byte) == Reader::Event::packet ? 1 : 0;
  const bool whole = packets == 1 && reader.counts().bad() + reader.counts().skipped_bytes == 0;
  if (!whole && !part) return "an answer is not a valid packet";
  if (answer.delay < Time(0) || answer.delay > most) return "an answer has an invalid return delay";
  return std::nullopt;
}

Complaint judge_answer(const sim::VirtualServo::Answer& answer, servo_bus::Protocol protocol) {
  if (protocol == servo_bus::Protocol::feetech)
    return judge_answer<feetech::PacketReader>(answer, false, std::chrono::microseconds(508));
  // After a fast read. To a broadcast ping each servo answers in its slot.
  return judge_answer<dynamixel::PacketReader>(answer, true, std::chrono::seconds(5));
}

}  // namespace

Complaint try_servo_bus(Bytes bytes) {
  Choices choices(bytes);
  const auto models = servo_bus::models();
  const servo_bus::Model& model = models[choices.below(static_cast<unsigned>(models.size()))];
  const auto servo = sim::VirtualServo::make(model, 1);
  const bool feetech = model.protocol == servo_bus::Protocol::feetech;
  sim::ServoReading reading{model.steps / 2.0, 0, 0, 25, feetech ? 6.5 : 5};
  servo->set_power(false, reading);
  servo->set_power(true, reading);
  Time now{};
  while (!choices.ended()) {
    for (const std::uint8_t byte : next_bytes(choices, model.protocol)) {
      now += std::chrono::microseconds(10);
      if (const auto answer = servo->take(byte, now)) {
        if (auto wrong = judge_answer(*answer, model.protocol)) return wrong;
      }
    }
    if (servo->baud() < 9600 || servo->baud() > 4'500'000) return "an invalid baud rate";
    for (unsigned steps = choices.below(8); steps > 0; --steps) {
      now += std::chrono::milliseconds(1);
      const auto drive = servo->step(reading, 1e-3, now);
      if (!(std::abs(drive.duty) <= 1)) return "an invalid duty";
      reading.speed = drive.powered ? 5000 * drive.duty : 0;
      reading.steps += 1e-3 * reading.speed;
      reading.current_a = 2 * drive.duty;
    }
    if (auto wrong = judge_registers(servo->registers())) return wrong;
  }
  // Whatever was begun or restarted: after a second of silence it answers.
  now += std::chrono::seconds(1);
  const auto id = static_cast<std::uint8_t>(servo->registers().get("id"));
  bool answered = false;
  const Wire ping = feetech
                        ? feetech::wire_of(feetech::request(id, feetech::Instruction::ping))
                        : dynamixel::wire_of(dynamixel::request(id, dynamixel::Instruction::ping));
  for (const auto byte : ping) answered = servo->take(byte, now).has_value() || answered;
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

namespace {

Complaint try_answers(Bytes bytes, const servo_bus::Model* model) {
  HostileServos servos(bytes);
  auto board = host::BusBoard::open(servos, servos, {{{"a", 1, model, 2048, false}, -1, 1}});
  if (!board) return judge_error(board.error(), "bus", board.error().fault);
  for (std::uint8_t i = 0; i < 50; ++i) {
    // Now and then on, off and cleared.
    constexpr std::array<std::uint8_t, 8> kTypes{KZ_TYPE_state, KZ_TYPE_enable, KZ_TYPE_state,
                                                 KZ_TYPE_state, KZ_TYPE_stop,   KZ_TYPE_state,
                                                 KZ_TYPE_clear, KZ_TYPE_state};
    const std::uint8_t type = kTypes[i % kTypes.size()];
    std::vector<std::uint8_t> body{1, type, i};
    if (type == KZ_TYPE_enable) body.insert(body.end(), {0, 0, 0, 1});
    std::array<std::uint8_t, KZ_FRAME_MAX> wire{};
    const auto length =
        kz_frame_encode(body.data(), static_cast<std::uint8_t>(body.size()), wire.data());
    board->take(std::span(wire).first(length));
    const auto answer = board->serve();
    if (!answer || !*answer) return "a request is not answered";
    kz_receiver receiver;
    kz_receiver_init(&receiver);
    bool whole = false;
    for (const std::uint8_t byte : **answer)
      whole = kz_receive(&receiver, byte, 0) == KZ_RECEIVE_FRAME || whole;
    if (type == KZ_TYPE_stop && whole) {
      const bool on = (receiver.body[KZ_HEADER_SIZE + 5] & KZ_STATUS_ENABLED) != 0;
      if (on == board->still_on().empty()) return "the reply to `stop` and still_on() disagree";
    }
    kz_state_reply state{};
    if (type != KZ_TYPE_state) {
      if (!whole) return "an answer is not a valid frame";
    } else if (!whole || !kz_unpack_state_reply(&state, receiver.body + KZ_HEADER_SIZE,
                                                static_cast<u8>(receiver.length - KZ_HEADER_SIZE)))
      return "an answer is not a valid state reply";
    (void)servos.sleep_until(servos.now() + std::chrono::milliseconds(10));
  }
  return std::nullopt;
}

Complaint try_scan(Bytes bytes, servo_bus::Protocol protocol) {
  HostileServos servos(bytes);
  host::ScanOptions options;
  options.last_id = 3;
  options.readings = 5;
  const auto found = host::scan_bus(servos, servos, protocol, 1000000, options);
  if (!found) return judge_error(found.error(), "bus", found.error().fault);
  for (const host::ScannedServo& servo : *found) {
    if (servo.id < 0 || servo.id > 3) return "a servo has an id outside the scanned range";
    if (servo.lost + servo.damaged > servo.requests)
      return "more answers were lost or damaged than requested";
    if (servo.model != nullptr && servo.model->protocol != protocol)
      return "a servo has a model of the other protocol";
    for (const host::ScanRemark& remark : host::remarks_on(servo, protocol))
      if (remark.text.empty()) return "a remark without text";
  }
  return std::nullopt;
}

// A hostile servo passes no run by keeping silent, and the judge ends whatever it says.
Complaint try_judge(Bytes bytes, hil::ServoFamily family) {
  const hil::Bytes all(bytes.begin(), bytes.end());
  for (const hil::ServoAnswer& one : hil::answers_in(family, all).all)
    if (one.id < 0 || one.id > 255 || one.data.size() > all.size()) return "an invalid answer";
  HostileServos servos(bytes);
  hil::BusRunOptions options;
  options.family = family;
  options.allowed = hil::kServoMotion | hil::kServoEeprom | hil::kServoAlone;
  const auto report = hil::run_bus_suite(servos, servos, options);
  if (!report) return judge_error(report.error(), "bus", report.error().fault);
  if (report->results.size() != hil::servo_cases(family).size()) return "cases are missing";
  return std::nullopt;
}

}  // namespace

// The same bytes for the drivers, scans and judges of both protocols.
Complaint try_bus_answers(Bytes bytes) {
  for (const auto family : {hil::ServoFamily::feetech, hil::ServoFamily::dynamixel})
    if (auto wrong = try_judge(bytes, family)) return wrong;
  for (const char* model : {"sts3215", "xl330-m288"}) {
    if (auto wrong = try_answers(bytes, servo_bus::find_model(model))) return wrong;
    if (auto wrong = try_scan(bytes, servo_bus::find_model(model)->protocol)) return wrong;
  }
  return std::nullopt;
}

Complaint try_bus_file(Bytes bytes) {
  const auto file = servo_bus::parse_bus_file("bus.json", text_of(bytes));
  if (!file) return judge_error(file.error(), "bus.json");
  if (!(file->supply_volts >= 0 && file->supply_ohm >= 0) || file->servos.empty())
    return "an invalid bus was read";
  for (const servo_bus::BusServo& servo : file->servos) {
    if (servo.id < 0 || servo.id > feetech::kMaxId || servo.model == nullptr ||
        servo.model->protocol != file->protocol || !std::isfinite(servo.steps_at(1)))
      return "an invalid servo was read";
    for (const servo_bus::BusSetting& one : file->settings) {
      const servo_bus::Register* reg = servo.model->find(one.name);
      if (reg == nullptr || !reg->eeprom || !reg->allows(one.value))
        return "an invalid setting was read";
    }
  }
  const std::string& joint = file->servos.front().joint;
  const auto again =
      servo_bus::parse_bus_file("bus.json", servo_bus::with_zeros(text_of(bytes), {{joint, 77}}));
  if (!again || again->servos.size() != file->servos.size() || again->servos.front().zero != 77)
    return "after a change of a zero position, the file is read differently";
  return std::nullopt;
}

}  // namespace kaz::fuzz
