// Decodes the tick's structures from the memory of the H8.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/h8_layout.h"

#include <algorithm>

namespace kaz::sim::h8_layout {
namespace {

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  std::uint32_t take(std::size_t size) {
    const std::uint32_t value = number(bytes_, at_, size);
    at_ += size;
    return value;
  }
  void read(u8& value) { value = static_cast<u8>(take(1)); }
  void read(u16& value) { value = static_cast<u16>(take(2)); }
  void read(s16& value) { value = static_cast<s16>(take(2)); }
  void read(u32& value) { value = take(4); }
  template <class T, std::size_t N>
  void read(T (&values)[N]) {
    for (T& value : values) read(value);
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

}  // namespace

std::uint32_t number(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes[at + i];
  return value;
}

kz_startup decode_startup(std::span<const std::uint8_t, kStartupSize> bytes) {
  Reader reader(bytes);
  kz_startup startup{};
  reader.read(startup.image_crc);
  reader.read(startup.start_8states);
  reader.read(startup.reset_cause);
  reader.read(startup.tests_done);
  reader.read(startup.tests_failed);
  reader.read(startup.address);
  reader.read(startup.shared_line);
  reader.read(startup.calibration);
  reader.read(startup.pot_centre);
  reader.read(startup.pot_scale);
  return startup;
}

kz_tick_input decode_input(std::span<const std::uint8_t, kInputSize> bytes) {
  Reader reader(bytes);
  kz_tick_input input{};
  reader.read(input.tick);
  reader.read(input.busy_8states);
  reader.read(input.worst_8states);
  reader.read(input.missed);
  reader.read(input.calibration_sequence);
  reader.read(input.analog);
  reader.read(input.erases_a);
  reader.read(input.erases_b);
  reader.read(input.result);
  reader.read(input.tx_room);
  reader.read(input.rx_count);
  reader.read(input.rx);
  reader.read(input.rx_flags);
  return input;
}

kz_tick_output decode_output(std::span<const std::uint8_t, kOutputSize> bytes) {
  Reader reader(bytes);
  kz_tick_output output{};
  reader.read(output.pw);
  reader.read(output.tmo);
  reader.read(output.p3);
  reader.read(output.p4);
  reader.read(output.p5);
  reader.read(output.p6);
  reader.read(output.action);
  reader.read(output.tx_count);
  reader.read(output.tx);
  return output;
}

}  // namespace kaz::sim::h8_layout
