// Reads fields by the list that the comparison of the engines uses.
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/campaign/servo_view.h"

#include <stdexcept>
#include <string>

#include "shared/servo/fields.h"
#include "sim/mcu/h8_layout.h"

namespace kaz::campaign {
namespace {

const kz_state_field& field(std::string_view name) {
  for (int f = 0; f < kz_state_field_count; ++f)
    if (name == kz_state_fields[f].name) return kz_state_fields[f];
  throw std::invalid_argument("the servo's state has no field " + std::string(name));
}

}  // namespace

ServoState servo_state(const sim::H8Mcu& mcu) {
  static const kz_state_field &enabled = field("enabled"), &holding = field("holding"),
                              &angle = field("joint.angle"), &command = field("joint.command");
  const auto bytes = mcu.global("kz_servo_state", kz_state_size_h8);
  if (bytes.empty()) throw std::invalid_argument("the image has no symbols");
  const auto number = [&bytes](const kz_state_field& f, std::size_t i) {
    return sim::h8_layout::number(bytes, f.offset + i * f.stride, f.size);
  };
  ServoState state;
  state.enabled = number(enabled, 0);
  state.holding = number(holding, 0) != 0;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    state.angle[j] = static_cast<std::int16_t>(number(angle, j));
    state.command[j] = static_cast<std::int16_t>(number(command, j));
  }
  return state;
}

}  // namespace kaz::campaign
