// Pings every id, and reads whoever answers.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/bus_scan.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <set>
#include <span>

#include "host/link/drain.h"
#include "shared/dynamixel/packet.h"
#include "shared/feetech/packet.h"

namespace kaz::host {
namespace {

using servo_bus::Model;
using servo_bus::Protocol;

struct FeetechWire {
  using Packet = feetech::Packet;
  using Reader = feetech::PacketReader;
  static constexpr Protocol kProtocol = Protocol::feetech;
  static constexpr std::string_view kModel = "model", kDelay = "return_delay";
  static constexpr std::string_view kVolts = "present_voltage";
  // A read: the answer to a ping of a servo whose voltage is wrong has the bytes of the ping itself, and
  // would pass for an adapter's echo.
  static Packet ping(std::uint8_t id) { return read(id, kId, 1); }
  static constexpr std::size_t kId = 5;
  static Packet read(std::uint8_t id, std::size_t address, std::size_t count) {
    return feetech::request(id, feetech::Instruction::read,
                            {static_cast<std::uint8_t>(address), static_cast<std::uint8_t>(count)});
  }
  static std::vector<std::uint8_t> wire_of(const Packet& packet) {
    return feetech::wire_of(packet);
  }
  static bool is_answer(const Packet&) { return true; }
  // A read that failed has no parameters.
  static std::uint8_t errors(const Packet& answer) { return answer.code; }
};

struct DynamixelWire {
  using Packet = dynamixel::Packet;
  using Reader = dynamixel::PacketReader;
  static constexpr Protocol kProtocol = Protocol::dynamixel;
  static constexpr std::string_view kModel = "model_number", kDelay = "return_delay_time";
  static constexpr std::string_view kVolts = "present_input_voltage";
  static Packet ping(std::uint8_t id) {
    return dynamixel::request(id, dynamixel::Instruction::ping);
  }
  static Packet read(std::uint8_t id, std::size_t address, std::size_t count) {
    using dynamixel::high, dynamixel::low;
    return dynamixel::request(id, dynamixel::Instruction::read,
                              {low(address), high(address), low(count), high(count)});
  }
  static std::vector<std::uint8_t> wire_of(const Packet& packet) {
    return dynamixel::wire_of(packet);
  }
  static bool is_answer(const Packet& packet) { return packet.is_status(); }
  static std::uint8_t errors(const Packet&) { return 0; }  // in a register
};

template <class Wire>
class Scan {
 public:
  Scan(Link& link, Clock& clock, long baud, const ScanOptions& options)
      : link_(link), clock_(clock), options_(options) {
    constexpr double kBits = 10, kLongest = 60;  // of a byte; bytes of request and answer
    const Time within =
        options.within > Time::zero() ? options.within : std::chrono::milliseconds(8);
    within_ = within + from_seconds(kBits * kLongest / static_cast<double>(baud));
  }

  Result<std::vector<ScannedServo>> run() {
    std::vector<ScannedServo> found;
    std::vector<int> undecided;
    bool restarted = false;
    // Once fast; where somebody is, those that were silent again: an answer may have been late. On a machine
    // that was late, some times more.
    for (int pass = 0; pass < 2 || (!undecided.empty() && pass <= kMoreOften); ++pass) {
      undecided.clear();
      for (int id = options_.first_id; id <= options_.last_id; ++id) {
        if (std::ranges::find(found, id, &ScannedServo::id) != found.end()) continue;
        if (options_.progress && pass == 0) options_.progress(id);
        ScannedServo servo;
        servo.id = id;
        const auto answer = KAZ_TRY(request(servo, Wire::ping(static_cast<std::uint8_t>(id))));
        if (slow_adapter_ && !restarted) break;
        if (!answer && servo.late > 0) undecided.push_back(id);
        if (!answer && servo.damaged == 0) continue;
        found.push_back(servo);
      }
      if (found.empty() && !slow_adapter_) KAZ_TRY(await_late_answer());
      if (slow_adapter_ && !restarted) {
        restarted = true;
        KAZ_TRY(discard());
        found.clear();
        pass = -1;
        continue;
      }
      if (found.empty()) break;
    }
    std::ranges::sort(found, {}, &ScannedServo::id);
    const std::vector<ScannedServo> unread = found;
    for (ScannedServo& servo : found) KAZ_TRY(read(servo));
    for (int again = 0; again < kMoreOften && !excuse_.empty(); ++again) {
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (found[i].lost + found[i].late == 0) continue;
        found[i] = unread[i];
        KAZ_TRY(read(found[i]));
      }
    }
    if (!excuse_.empty()) {
      for (ScannedServo& servo : found) excuse_losses(servo);
    }
    if (options_.undecided) {
      for (const int id : undecided) options_.undecided(id, excuse_);
    }
    return found;
  }

 private:
  using Answer = std::optional<typename Wire::Packet>;
  static constexpr int kMoreOften = 4;

  // The simulator of a bus, too, may have been late without having noticed: on a machine that is late now and
  // then, no missing answer is the cable's.
  static void excuse_losses(ScannedServo& servo) {
    servo.late += servo.lost;
    servo.requests -= servo.lost;
    servo.lost = 0;
  }

  void wait_longer() {
    slow_adapter_ = true;
    within_ += kSlowWithin;
  }

  // Returns the number of bytes that arrive within kSlowWithin.
  Result<std::size_t> discard() {
    const Time end = clock_.now() + kSlowWithin;
    std::array<std::uint8_t, 64> bytes{};
    std::size_t count = 0;
    while (clock_.now() < end) {
      const std::size_t come = KAZ_TRY(link_.read(bytes, end));
      count += come;
    }
    return count;
  }

  Result<void> await_late_answer() {
    if (within_ >= kSlowWithin) return {};
    const std::size_t late = KAZ_TRY(discard());
    if (late > 0) wait_longer();
    return {};
  }

  // A request that failed while this machine was late proves nothing: it is repeated, and not counted.
  Result<Answer> request(ScannedServo& servo, const typename Wire::Packet& packet) {
    LatenessMeter* const lateness = options_.lateness;
    for (int again = lateness ? LatenessMeter::kRepetitions : 0;; --again) {
      const int lost = servo.lost, damaged = servo.damaged;
      KAZ_TRY(repeat_if_late(lateness, [this] { return drain(link_, clock_); }));
      if (lateness) lateness->begin();
      auto answer = KAZ_TRY(request_once(servo, packet));
      const std::string excuse = lateness ? lateness->excuse() : "";
      if (excuse.empty()) return answer;
      excuse_ = excuse;
      if (answer) {
        servo.round_trips_s.pop_back();
        return answer;
      }
      --servo.requests;
      servo.lost = lost;
      servo.damaged = damaged;
      if (again > 0 && !lateness->other_end_gone()) continue;
      ++servo.late;
      return answer;
    }
  }

  Result<Answer> request_once(ScannedServo& servo, const typename Wire::Packet& packet) {
    std::array<std::uint8_t, 256> bytes{};
    ++servo.requests;
    const Time begin = clock_.now();
    KAZ_TRY(link_.write(Wire::wire_of(packet)));
    typename Wire::Reader reader;
    bool came = false;
    // Once more after the time is up: of a program that was kept waiting the answer may be there.
    for (bool last = false; !last;) {
      last = clock_.now() >= begin + within_;
      const std::size_t count = KAZ_TRY(link_.read(bytes, begin + within_));
      for (const std::uint8_t byte : std::span(bytes).first(count)) {
        const auto event = reader.take(byte);
        came = true;
        if (event == Wire::Reader::Event::none) continue;
        // An adapter may hand back the request itself.
        if (event == Wire::Reader::Event::packet && reader.packet() == packet) {
          came = false;
          continue;
        }
        const bool whole = event == Wire::Reader::Event::packet;
        const bool foreign = whole && reader.packet().id != servo.id;
        // The answer to an earlier request, or its echo.
        if (foreign && within_ < kSlowWithin) {
          wait_longer();
          return Answer();
        }
        if (!whole || foreign || !Wire::is_answer(reader.packet())) {
          ++servo.damaged;
          return Answer();
        }
        servo.round_trips_s.push_back(seconds(clock_.now() - begin));
        return Answer(reader.packet());
      }
    }
    ++(came ? servo.damaged : servo.lost);
    return Answer();
  }

  Result<std::optional<std::vector<std::uint8_t>>> block(ScannedServo& servo, std::size_t address,
                                                         std::size_t count) {
    using Block = std::optional<std::vector<std::uint8_t>>;
    const int lost = servo.lost;
    const bool fast = !slow_adapter_;
    const auto answer =
        KAZ_TRY(request(servo, Wire::read(static_cast<std::uint8_t>(servo.id), address, count)));
    if (!answer && servo.lost > lost) KAZ_TRY(await_late_answer());
    if (fast && slow_adapter_) {
      --servo.requests;
      servo.lost = lost;
      return block(servo, address, count);
    }
    if (!answer) return Block();
    servo.errors = static_cast<std::uint8_t>(servo.errors | Wire::errors(*answer));
    if (answer->parameters.size() != count) return Block();
    return Block(answer->parameters);
  }

  // Each a few times: an answer may be lost.
  Result<std::optional<int>> value(ScannedServo& servo, const Model& model, std::string_view name) {
    const servo_bus::Register* reg = model.find(name);
    for (int tries = 0; reg != nullptr && tries < 5; ++tries) {
      const auto bytes = KAZ_TRY(block(servo, reg->address, reg->size));
      if (bytes) return std::optional<int>(servo_bus::decode(model, *reg, *bytes));
    }
    return std::optional<int>();
  }

  Result<void> read(ScannedServo& servo) {
    // All models of a maker have what is read here at the same places.
    const auto& all = servo_bus::models();
    const Model& any = *std::ranges::find(all, Wire::kProtocol, &Model::protocol);
    const servo_bus::Register& number = *any.find(Wire::kModel);
    for (int tries = 0; tries < 5 && servo.number < 0; ++tries) {
      const auto bytes = KAZ_TRY(block(servo, number.address, number.size));
      if (!bytes) continue;
      servo.number = servo_bus::decode(any, number, *bytes);
      // Feetech's makers do not agree on the order of bytes.
      for (const Model& one : all) {
        if (one.protocol != Wire::kProtocol || servo_bus::decode(one, number, *bytes) != one.number)
          continue;
        servo.model = &one;
        servo.number = one.number;
      }
    }
    const Model& model = servo.model != nullptr ? *servo.model : any;
    const auto delay = KAZ_TRY(value(servo, model, Wire::kDelay));
    if (delay) servo.return_delay_s = 1e-9 * servo_bus::kReturnDelayUnitNs * *delay;
    servo.torque = KAZ_TRY(value(servo, model, "torque_enable")).value_or(-1);
    if (const auto errors = KAZ_TRY(value(servo, model, "hardware_error_status")))
      servo.errors = static_cast<std::uint8_t>(servo.errors | *errors);
    const servo_bus::Register &first = *model.find("present_position"),
                              &volts = *model.find(Wire::kVolts),
                              &celsius = *model.find("present_temperature");
    const auto count = static_cast<std::size_t>(celsius.end() - first.address);
    for (int i = 0; i < options_.readings; ++i) {
      const auto bytes = KAZ_TRY(block(servo, first.address, count));
      if (!bytes) continue;
      const auto at = [&](const servo_bus::Register& reg) {
        return servo_bus::decode(
            model, reg,
            std::span(*bytes).subspan(static_cast<std::size_t>(reg.address - first.address),
                                      reg.size));
      };
      servo.volts = at(volts) / 10.0;
      servo.lowest_volts =
          std::isnan(servo.lowest_volts) ? servo.volts : std::min(servo.lowest_volts, servo.volts);
      servo.celsius = at(celsius);
    }
    return {};
  }

  Link& link_;
  Clock& clock_;
  const ScanOptions& options_;
  Time within_{};
  // The adapter holds answers for longer than within_ was. FTDI's adapters hold them for 16 ms.
  bool slow_adapter_ = false;
  static constexpr Time kSlowWithin = std::chrono::milliseconds(25);
  std::string excuse_;  // the last one; empty: this machine was never late
};

// The bits of both makers' error bytes.
std::string errors_text(std::uint8_t errors, Protocol protocol) {
  struct Bit {
    int bit;
    const char* text;
  };
  static constexpr std::array kFeetech{Bit{feetech::kVoltageError, "its voltage is out of bounds"},
                                       Bit{feetech::kEncoderError, "its position sensor fails"},
                                       Bit{feetech::kTemperatureError, "it is too hot"},
                                       Bit{feetech::kCurrentError, "its current is too large"},
                                       Bit{feetech::kAngleError, "its angle is out of bounds"},
                                       Bit{feetech::kOverloadError, "it is overloaded"}};
  static constexpr std::array kDynamixel{
      Bit{dynamixel::kVoltageError, "its voltage is out of bounds"},
      Bit{dynamixel::kTemperatureError, "it is too hot"},
      Bit{dynamixel::kEncoderError, "its position sensor fails"},
      Bit{dynamixel::kShockError,
          "its circuit had an electrical shock, or its supply is too weak for the motor"},
      Bit{dynamixel::kOverloadError, "it is overloaded"}};
  std::string text;
  const auto add = [&](std::span<const Bit> bits) {
    for (const Bit& one : bits)
      if ((errors & one.bit) != 0) text += (text.empty() ? "" : ", ") + std::string(one.text);
  };
  protocol == Protocol::feetech ? add(kFeetech) : add(kDynamixel);
  return text;
}

}  // namespace

Result<std::vector<ScannedServo>> scan_bus(Link& link, Clock& clock, Protocol protocol, long baud,
                                           const ScanOptions& options) {
  return protocol == Protocol::feetech ? Scan<FeetechWire>(link, clock, baud, options).run()
                                       : Scan<DynamixelWire>(link, clock, baud, options).run();
}

std::vector<long> bus_rates(Protocol protocol) {
  std::set<long, std::greater<>> rates;
  for (const Model& model : servo_bus::models()) {
    if (model.protocol == protocol) rates.insert(model.bauds.begin(), model.bauds.end());
  }
  const long factory = servo_bus::factory_baud(protocol);
  rates.erase(factory);
  std::vector<long> all{factory};
  all.insert(all.end(), rates.begin(), rates.end());
  return all;
}

std::vector<ScanRemark> remarks_on(const ScannedServo& servo, Protocol protocol) {
  std::vector<ScanRemark> all;
  if (const std::string errors = errors_text(servo.errors, protocol); !errors.empty())
    all.push_back({true, errors});
  const int bad = servo.lost + servo.damaged;
  char text[200];
  // A noisy wire damages every servo's answers, and few of them.
  if (servo.damaged >= 3 && 4 * servo.damaged >= servo.requests) {
    std::snprintf(
        text, sizeof text,
        "%d of %d answers are damaged, perhaps because two servos have this id: connect one of "
        "them alone and change its id",
        servo.damaged, servo.requests);
    all.push_back({true, text});
  } else if (bad > 0) {
    std::snprintf(
        text, sizeof text,
        "%d requests: %d without an answer, %d damaged answers: check plugs, cable length and "
        "supply",
        servo.requests, servo.lost, servo.damaged);
    all.push_back({true, text});
  }
  if (servo.late > 0) {
    std::snprintf(
        text, sizeof text,
        "%d unanswered requests are inconclusive because this machine was late: end other programs "
        "and scan again",
        servo.late);
    all.push_back({false, text});
  }
  if (servo.number >= 0 && servo.model == nullptr)
    all.push_back({false, "Kaz has no register table for this model"});
  if (servo.return_delay_s > 20e-6) {
    std::snprintf(text, sizeof text,
                  "waits %.0f us before each answer: set its register %s to 0 for shorter cycles",
                  1e6 * servo.return_delay_s,
                  protocol == Protocol::feetech ? "return_delay" : "return_delay_time");
    all.push_back({false, text});
  }
  return all;
}

}  // namespace kaz::host
