// Each tick of an engine, computed again.
// SPDX-License-Identifier: Apache-2.0
#include "tools/fuzz/shadow.h"

#include <algorithm>
#include <cstring>

#include "shared/servo/fields.h"
#include "sim/mcu/h8_layout.h"

namespace kaz::fuzz {
namespace {

std::uint32_t native_number(const std::uint8_t* at, std::size_t size) {
  std::uint32_t value = 0;
  std::memcpy(&value, at, size);  // little-endian
  return value;
}

}  // namespace

kz_startup Shadow::startup() const {
  const auto found = h8_->global("kz_startup_found", sim::h8_layout::kStartupSize);
  return sim::h8_layout::decode_startup(
      std::span<const std::uint8_t, sim::h8_layout::kStartupSize>(found));
}

bool Shadow::tick(const sim::TickRecord& record) {
  const bool first = !last_tick_ || record.input.tick <= *last_tick_;
  last_tick_ = record.input.tick;
  kz_tick_output output{};
  if (first) {
    const kz_startup found = startup();
    servo_ = {};
    kz_servo_init(&servo_, &found, &output);
  }
  kz_tick(&servo_, &record.input, &output);
  ++ticks_;
  const auto check = [&](const char* name, int here, int there) {
    if (here != there) differ(record.input, std::string("output.").append(name), here, there);
  };
  for (int i = 0; i < 16; ++i) check("pw", output.pw[i], record.output.pw[i]);
  for (int i = 0; i < 2; ++i) check("tmo", output.tmo[i], record.output.tmo[i]);
  check("p3", output.p3, record.output.p3);
  check("p4", output.p4, record.output.p4);
  check("p5", output.p5, record.output.p5);
  check("p6", output.p6, record.output.p6);
  check("action", output.action, record.output.action);
  check("tx_count", output.tx_count, record.output.tx_count);
  for (int i = 0; i < std::min<int>(output.tx_count, record.output.tx_count); ++i)
    check("tx", output.tx[i], record.output.tx[i]);
  if (ticks_ % 64 == 0 && !difference_) compare_state(record.input);
  return first;
}

void Shadow::differ(const kz_tick_input& input, const std::string& what, long long here,
                    long long there) {
  if (difference_) return;
  difference_ = std::string("tick ")
                    .append(std::to_string(input.tick))
                    .append(": native and h8 differ: ")
                    .append(what)
                    .append(" is ")
                    .append(std::to_string(here))
                    .append(" and ")
                    .append(std::to_string(there));
}

void Shadow::compare_state(const kz_tick_input& input) {
  const auto h8 = h8_->global("kz_servo_state", kz_state_size_h8);
  const auto* native = reinterpret_cast<const std::uint8_t*>(&servo_);
  for (std::size_t f = 0; f < kz_state_field_count; ++f) {
    const kz_state_field& field = kz_state_fields[f];
    for (std::size_t i = 0; i < field.count; ++i) {
      const std::size_t at = field.offset + i * field.stride;
      const std::uint32_t here = native_number(native + at, field.size);
      const std::uint32_t there = sim::h8_layout::number(h8, at, field.size);
      if (here != there)
        differ(input,
               std::string("state.").append(field.name).append(" ").append(std::to_string(i)), here,
               there);
    }
  }
}

}  // namespace kaz::fuzz
