// A session as JSON: chip, pins, supply, joints, line.
// SPDX-License-Identifier: Apache-2.0
#include "tools/board_page/view.h"

#include <cstdio>
#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>

#include "shared/board/table.h"
#include "shared/servo/fields.h"
#include "shared/servo/status.h"
#include "sim/h8s/chip/registers.h"
#include "sim/mcu/h8_layout.h"

namespace kaz::board_page {
namespace {

// Writes JSON objects and lists; the names are ours and need no escapes.
class Json {
 public:
  Json& begin(char bracket) {
    comma();
    text_ += bracket;
    fresh_ = true;
    return *this;
  }
  Json& end(char bracket) {
    text_ += bracket;
    fresh_ = false;
    return *this;
  }
  Json& name(const char* name) {
    comma();
    text_ += '"';
    text_ += name;
    text_ += "\":";
    fresh_ = true;
    return *this;
  }
  Json& value(double number) {
    char digits[40];
    std::snprintf(digits, sizeof digits, "%.17g", number);
    return put(digits);
  }
  Json& value(bool yes) { return put(yes ? "true" : "false"); }
  Json& null() { return put("null"); }
  Json& value(const std::string& text) {
    comma();
    text_ += '"';
    for (const char c : text) {
      if (c == '"' || c == '\\') text_ += '\\';
      if (c == '\n') {
        text_ += "\\n";
      } else if (static_cast<unsigned char>(c) >= 0x20) {
        text_ += c;
      }
    }
    text_ += '"';
    return *this;
  }
  template <class T>
  Json& field(const char* key, T number) {
    name(key);
    if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>)
      return value(number);
    else
      return value(static_cast<double>(number));
  }
  std::string take() { return std::move(text_); }

 private:
  void comma() {
    if (!fresh_) text_ += ',';
    fresh_ = false;
  }
  Json& put(const char* token) {
    comma();
    text_ += token;
    return *this;
  }
  std::string text_;
  bool fresh_ = true;
};

// The servo's state as it is in the chip's RAM; nullopt: the image has no symbols, or no tick has begun, so
// that RAM has what it has when the power comes.
std::optional<kz_servo> servo_of(const sim::H8Mcu& mcu) {
  const auto h8 = mcu.global("kz_servo_state", kz_state_size_h8);
  if (h8.empty()) return std::nullopt;
  kz_servo servo{};
  auto* native = reinterpret_cast<std::uint8_t*>(&servo);
  for (std::size_t f = 0; f < kz_state_field_count; ++f) {
    const kz_state_field& field = kz_state_fields[f];
    for (std::size_t i = 0; i < field.count; ++i) {
      const std::size_t at = field.offset + i * field.stride;
      const std::uint32_t number = sim::h8_layout::number(h8, at, field.size);
      for (std::size_t byte = 0; byte < field.size; ++byte)
        native[at + byte] = static_cast<std::uint8_t>(number >> 8 * byte);
    }
  }
  if (servo.tick > mcu.chip().now() / KZ_STATES_PER_TICK) return std::nullopt;
  return servo;
}

std::optional<kz_tick_input> input_of(const sim::H8Mcu& mcu) {
  const auto bytes = mcu.global("kz_input", sim::h8_layout::input_size);
  if (bytes.size() != sim::h8_layout::input_size) return std::nullopt;
  return sim::h8_layout::decode_input(
      std::span<const std::uint8_t, sim::h8_layout::input_size>(bytes));
}

void put_chip(Json& json, const sim::H8Mcu& mcu) {
  const h8s::Chip& chip = mcu.chip();
  const h8s::Registers registers = chip.registers();
  json.field("chip_states", chip.now()).field("instructions", chip.instructions());
  json.field("pc", registers.pc).field("ccr", registers.ccr).field("asleep", chip.asleep());
  json.field("symbol", chip.symbols().describe(registers.pc));
  json.field("next", chip.disassemble(registers.pc));
  json.name("er").begin('[');
  for (const std::uint32_t er : registers.er) json.value(static_cast<double>(er));
  json.end(']');
}

void put_registers(Json& json, const h8s::Chip& chip) {
  const auto peek = [&chip](std::uint32_t address) { return chip.peek(address); };
  json.name("registers").begin('[');
  for (const h8s::RegisterInfo& info : h8s::register_table()) {
    if (info.write_only || !h8s::selected(info, peek)) continue;
    const auto value = info.size == 2
                           ? chip.peek16(info.full_address())
                           : std::optional<std::uint16_t>(chip.peek(info.full_address()));
    if (!value) continue;
    json.begin('[').value(std::string(info.unit)).value(std::string(info.name));
    json.value(static_cast<double>(info.full_address())).value(static_cast<double>(info.size));
    json.value(static_cast<double>(*value)).end(']');
  }
  json.end(']');
}

void put_pins(Json& json, const sim::ServoBoard& board) {
  const sim::PinLevels& pins = board.pins();
  json.name("ports").begin('{').field("P3", pins.p3).field("P4", pins.p4).field("P5", pins.p5);
  json.field("P6", pins.p6).end('}');
  json.name("pw").begin('[');
  for (const std::uint16_t counts : pins.pw) json.value(static_cast<double>(counts));
  json.end(']').name("tmo").begin('[');
  for (const std::uint16_t counts : pins.tmo) json.value(static_cast<double>(counts));
  json.end(']').field("drivers", board.drivers_enabled());
}

void put_servo(Json& json, const kz_servo& servo) {
  json.name("servo").begin('{').field("tick", servo.tick).field("status", kz_status(&servo));
  json.field("enabled", servo.enabled).field("silent_ms", servo.silent_ms);
  json.field("watchdog_ms", servo.watchdog_ms).field("shutdown", servo.shutdown);
  json.field("detail", servo.shutdown_detail).field("shutdown_tick", servo.shutdown_tick);
  json.field("reset_cause", servo.reset_cause).field("supply_mv", servo.supply_mv);
  json.field("temperature_dc", servo.temperature_dc).field("tests_failed", servo.tests_failed);
  json.end('}');
}

void put_joints(Json& json, const Session& session, const std::optional<kz_servo>& servo) {
  const auto input = input_of(session.mcu());
  const auto states = session.stand().joints();
  json.name("joints").begin('[');
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    json.begin('{').field("angle", states[j].angle).field("speed", states[j].velocity);
    json.field("torque", states[j].torque).field("current", states[j].current);
    json.field("winding", states[j].winding_celsius);
    json.field("duty", sim::duty_of(session.board().pins(), j));
    json.name("hand");
    if (const auto& hand = session.hand(j)) {
      json.value(*hand);
    } else {
      json.null();
    }
    if (input) json.field("code", input->analog[kz_board_joints[j].analog]);
    if (servo) {
      const kz_joint& joint = servo->joint[j];
      json.field("target", joint.on ? joint.target : joint.angle).field("command", joint.command);
      json.field("measured", joint.angle).field("on", joint.on != 0);
      json.field("flags", kz_joint_flags(&joint, (servo->fresh_targets >> j & 1) != 0));
    }
    json.end('}');
  }
  json.end(']');
}

}  // namespace

std::string hex(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::string view_json(const Session& session, bool registers) {
  Json json;
  json.begin('{').field("states", session.now()).field("power", session.board().power());
  put_chip(json, session.mcu());
  put_pins(json, session.board());
  json.field("supply_volts", session.board().supply_volts());
  json.field("supply_amperes", session.stand().supply_current_a());
  json.field("driver_celsius", session.board().driver_celsius());
  const auto servo = servo_of(session.mcu());
  if (servo) put_servo(json, *servo);
  put_joints(json, session, servo);
  if (registers) put_registers(json, session.mcu().chip());
  return json.end('}').take();
}

std::string line_json(std::span<const LineEntry> entries) {
  Json json;
  json.begin('[');
  for (const LineEntry& entry : entries) {
    json.begin('{').field("out", entry.to_board).field("at", entry.at);
    json.field("wire", hex(entry.wire)).field("result", entry.result);
    json.field("body", hex(entry.body)).end('}');
  }
  return json.end(']').take();
}

}  // namespace kaz::board_page
