// Register tables of servos.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo_bus/registers.h"

#include <algorithm>
#include <array>

#include "shared/base/angle.hpp"

namespace kaz::servo_bus {
namespace {

constexpr bool r = false, rw = true, ram = false, eeprom = true;

// By code. Feetech's SDKs and memory tables; ROBOTIS's e-Manual.
constexpr long kFeetechBauds[] = {1000000, 500000, 250000, 128000, 115200, 76800, 57600, 38400};
constexpr long kX330Bauds[] = {9600, 57600, 115200, 1000000, 2000000, 3000000, 4000000};
constexpr long kX430Bauds[] = {9600, 57600, 115200, 1000000, 2000000, 3000000, 4000000, 4500000};

#define KZ_SERVO(...)
#define KZ_DYNAMIXEL(...)
#define KZ_INITIAL(...)
#define KZ_REGISTER(name, address, size, sign, access, area, initial, min, max, unit, effect, \
                    source)                                                                   \
  Register{#name, address, size, sign, access, area, initial, min, max, unit, effect, source},
#define KZ_CHOICE(name, address, size, access, area, initial, values, min, max, effect, source) \
  Register{#name, address, size,   0,      access, area, initial, min,                          \
           max,   "",      effect, source, 1,      0,    values},
#define KZ_ROW(name, address, size, count, access, area, initial, step, min, max, effect, source) \
  Register{#name, address, size, 0,      access, area,  initial,                                  \
           min,   max,     "",   effect, source, count, step},
constexpr Register kSts3215[] = {
#include "shared/feetech/sts3215.def"
};
constexpr Register kScs0009[] = {
#include "shared/feetech/scs0009.def"
};
constexpr Register kXl330[] = {
#include "shared/dynamixel/xl330.def"
};
constexpr Register kXl430[] = {
#include "shared/dynamixel/xl430.def"
};
constexpr Register kXm430[] = {
#include "shared/dynamixel/xm430.def"
};
#undef KZ_SERVO
#undef KZ_DYNAMIXEL
#undef KZ_INITIAL
#undef KZ_REGISTER
#undef KZ_CHOICE
#undef KZ_ROW

#define KZ_REGISTER(...)
#define KZ_CHOICE(...)
#define KZ_ROW(...)

#define KZ_SERVO(...)
#define KZ_DYNAMIXEL(...)
#define KZ_INITIAL(model, name, value) Change{model, #name, value},
constexpr Change kChanges[] = {
#include "shared/dynamixel/xl330.def"
};
#undef KZ_SERVO
#undef KZ_DYNAMIXEL
#undef KZ_INITIAL

constexpr bool little = false, big = true, winding = false, supply = true;
#define KZ_INITIAL(...)
#define KZ_SERVO(model, words, code, order, count, degrees, goes_on, syncs, unit_ms, table) \
  Model{.name = #model,                                                                     \
        .title = words,                                                                     \
        .number = code,                                                                     \
        .big_endian = order,                                                                \
        .steps = count,                                                                     \
        .span_rad = degrees * kDegree,                                                      \
        .full_turn = goes_on,                                                               \
        .sync_read = syncs,                                                                 \
        .protection_unit_ms = unit_ms,                                                      \
        .bauds = kFeetechBauds,                                                             \
        .registers = table},
#define KZ_DYNAMIXEL(model, words, code, p_unit, current_unit, place, rpm, volts, rates, table) \
  Model{.name = model,                                                                          \
        .title = words,                                                                         \
        .protocol = Protocol::dynamixel,                                                        \
        .number = code,                                                                         \
        .steps = 4096,                                                                          \
        .span_rad = 360 * kDegree,                                                              \
        .full_turn = true,                                                                      \
        .sync_read = true,                                                                      \
        .position_p_unit = p_unit,                                                              \
        .current_unit_a = current_unit,                                                         \
        .senses_supply_current = place,                                                         \
        .free_rpm_per_volt = (rpm) / (volts),                                                   \
        .bauds = rates,                                                                         \
        .registers = table},
constexpr Model kModels[] = {
#include "shared/dynamixel/xl330.def"
#include "shared/dynamixel/xl430.def"
#include "shared/dynamixel/xm430.def"
#include "shared/feetech/scs0009.def"
#include "shared/feetech/sts3215.def"
};
#undef KZ_SERVO
#undef KZ_DYNAMIXEL
#undef KZ_INITIAL
#undef KZ_REGISTER
#undef KZ_CHOICE
#undef KZ_ROW

}  // namespace

std::string_view name_of(Protocol protocol) {
  return protocol == Protocol::feetech ? "feetech" : "dynamixel";
}

long factory_baud(Protocol protocol) {
  return protocol == Protocol::feetech ? 1'000'000 : 57'600;
}

std::span<const Model> models() {
  return kModels;
}

const Model* find_model(std::string_view name) {
  const auto* found = std::ranges::find(kModels, name, &Model::name);
  return found == std::end(kModels) ? nullptr : found;
}

bool Register::allows(int value) const {
  if (value < min || value > max) return false;
  if (values.empty()) return true;
  // Numbers between spaces.
  int number = 0;
  for (const char c : values) {
    if (c == ' ' && number == value) return true;
    number = c == ' ' ? 0 : 10 * number + (c - '0');
  }
  return number == value;
}

const Register* Model::find(std::string_view wanted) const {
  const auto found = std::ranges::find(registers, wanted, &Register::name);
  return found == registers.end() ? nullptr : &*found;
}

const Register* Model::at(std::size_t address) const {
  const auto after = std::ranges::upper_bound(registers, address, {}, &Register::address);
  if (after == registers.begin()) return nullptr;
  const Register& reg = *(after - 1);
  return address < static_cast<std::size_t>(reg.end()) ? &reg : nullptr;
}

int Model::initial(const Register& reg, int index) const {
  for (const Change& change : kChanges) {
    if (change.model == name && change.name == reg.name) return change.initial;
  }
  return reg.initial + index * reg.initial_step;
}

int decode(const Model& model, const Register& reg, std::span<const std::uint8_t> bytes) {
  if (bytes.size() < reg.size) return 0;
  std::uint32_t raw = 0;
  for (std::size_t i = 0; i < reg.size; ++i)
    raw = raw << 8 | bytes[model.big_endian ? i : reg.size - 1 - i];
  const std::uint32_t sign = std::uint32_t{1} << reg.sign_bit;
  if (reg.sign_bit == 0 || (raw & sign) == 0) return static_cast<int>(raw);
  if (model.protocol == Protocol::dynamixel) return static_cast<int>(raw | ~(sign - 1));
  return -static_cast<int>(raw & (sign - 1));
}

std::vector<std::uint8_t> encode(const Model& model, const Register& reg, int value) {
  const int bits = reg.sign_bit != 0 ? reg.sign_bit : std::min(31, 8 * reg.size);
  const std::int64_t top = (std::int64_t{1} << bits) - 1;
  const bool complement = model.protocol == Protocol::dynamixel;
  const std::int64_t bottom = reg.sign_bit == 0 ? 0 : complement ? -top - 1 : -top;
  const std::int64_t limited = std::clamp<std::int64_t>(value, bottom, top);
  auto raw = static_cast<std::uint32_t>(limited);
  if (limited < 0 && !complement)
    raw = static_cast<std::uint32_t>(-limited) | std::uint32_t{1} << reg.sign_bit;
  std::vector<std::uint8_t> bytes(reg.size);
  for (std::size_t i = 0; i < reg.size; ++i)
    bytes[model.big_endian ? reg.size - 1 - i : i] = static_cast<std::uint8_t>(raw >> (8 * i));
  return bytes;
}

}  // namespace kaz::servo_bus
