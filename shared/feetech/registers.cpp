// Register tables of Feetech's servos.
// SPDX-License-Identifier: Apache-2.0
#include "shared/feetech/registers.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace kaz::feetech {
namespace {

constexpr bool r = false, rw = true, ram = false, eeprom = true;

#define KZ_SERVO(...)
#define KZ_REGISTER(name, address, size, sign, access, area, initial, min, max, unit, effect, \
                    source)                                                                   \
  Register{#name, address, size, sign, access, area, initial, min, max, unit, effect, source},
constexpr Register kSts3215[] = {
#include "shared/feetech/sts3215.def"
};
constexpr Register kScs0009[] = {
#include "shared/feetech/scs0009.def"
};
#undef KZ_SERVO
#undef KZ_REGISTER

constexpr double degree = std::numbers::pi / 180;
constexpr bool little = false, big = true;
#define KZ_REGISTER(...)
#define KZ_SERVO(name, title, number, order, steps, degrees, full_turn, sync_read, unit_ms, table) \
  Model{#name, title, number, order, steps, degrees * degree, full_turn, sync_read, unit_ms, table},
constexpr Model kModels[] = {
#include "shared/feetech/scs0009.def"
#include "shared/feetech/sts3215.def"
};
#undef KZ_SERVO
#undef KZ_REGISTER

}  // namespace

std::span<const Model> models() {
  return kModels;
}

const Model* find_model(std::string_view name) {
  const auto* found = std::ranges::find(kModels, name, &Model::name);
  return found == std::end(kModels) ? nullptr : found;
}

const Register* Model::find(std::string_view wanted) const {
  const auto found = std::ranges::find(registers, wanted, &Register::name);
  return found == registers.end() ? nullptr : &*found;
}

const Register* Model::at(std::uint8_t address) const {
  const auto found = std::ranges::find_if(registers, [&](const Register& reg) {
    return address >= reg.address && address < reg.address + reg.size;
  });
  return found == registers.end() ? nullptr : &*found;
}

int decode(const Model& model, const Register& reg, std::span<const std::uint8_t> bytes) {
  if (bytes.size() < reg.size) return 0;
  unsigned raw = bytes[0];
  if (reg.size == 2)
    raw = model.big_endian ? bytes[0] * 256u + bytes[1] : bytes[1] * 256u + bytes[0];
  if (reg.sign_bit == 0) return static_cast<int>(raw);
  const unsigned sign = 1u << reg.sign_bit;
  const int magnitude = static_cast<int>(raw & (sign - 1));
  return (raw & sign) != 0 ? -magnitude : magnitude;
}

std::vector<std::uint8_t> encode(const Model& model, const Register& reg, int value) {
  const int top = (1 << (reg.sign_bit != 0 ? reg.sign_bit : 8 * reg.size)) - 1;
  const int magnitude = std::min(value < 0 ? -std::max(value, -top) : value, top);
  unsigned raw = static_cast<unsigned>(magnitude);
  if (reg.sign_bit == 0 && value < 0) raw = 0;
  if (reg.sign_bit != 0 && value < 0) raw |= 1u << reg.sign_bit;
  const auto low = static_cast<std::uint8_t>(raw), high = static_cast<std::uint8_t>(raw >> 8);
  if (reg.size == 1) return {low};
  return model.big_endian ? std::vector{high, low} : std::vector{low, high};
}

}  // namespace kaz::feetech
