// Timing of the bytes on the line.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation/serial_line.h"

#include <algorithm>

#include "sim/h8s/chip/line_rate.h"
#include "sim/runtime/time.h"

namespace kaz::sim {

void SerialLine::queue(std::span<const std::uint8_t> bytes, States now, bool framing_error) {
  wire_free_ = std::max(wire_free_, now);
  for (const std::uint8_t value : bytes) {
    wire_free_ += 10 * host_bit_;
    pass(fault_to_board_, {value, wire_free_, framing_error, host_bit_}, to_board_);
  }
}

// Inserted, doubled or late bytes delay all following ones: the line carries one byte at a time.
void SerialLine::pass(faults::LinkFaults& link, const SerialByte& byte,
                      std::deque<SerialByte>& to) {
  if (schedule_ == nullptr || schedule_->empty()) {
    const States at = to.empty() ? byte.at : std::max(byte.at, to.back().at);
    to.push_back({byte.value, at, byte.framing_error, byte.bit_states});
    return;
  }
  const auto out = link.pass(*schedule_, time_of(byte.at), {byte.value, byte.framing_error});
  States at = byte.at + states_of(out.delay);
  for (std::size_t i = 0; i < out.count; ++i) {
    if (!to.empty()) at = std::max(at, to.back().at + 10 * byte.bit_states);
    to.push_back({out.bytes[i].value, at, out.bytes[i].framing_error, byte.bit_states});
  }
}

void SerialLine::write(std::span<const std::uint8_t> bytes, States now) {
  queue(bytes, now, false);
}

void SerialLine::write_garbled(std::span<const std::uint8_t> bytes, States now) {
  queue(bytes, now, true);
}

std::size_t SerialLine::waiting(States now) const {
  if (wire_free_ <= now) return 0;
  const States left = wire_free_ - now;
  const States byte = 10 * host_bit_;
  return static_cast<std::size_t>((left + byte - 1) / byte);
}

std::vector<SerialByte> SerialLine::take_for_board(States until) {
  std::vector<SerialByte> arrived;
  while (!to_board_.empty() && to_board_.front().at <= until) {
    arrived.push_back(to_board_.front());
    to_board_.pop_front();
  }
  return arrived;
}

void SerialLine::from_board(std::span<const SerialByte> bytes) {
  for (const SerialByte& byte : bytes) {
    const auto heard = h8s::heard_at(byte.value, byte.bit_states, host_bit_);
    if (heard.heard)
      pass(fault_to_host_, {heard.value, byte.at, heard.framing_error, byte.bit_states}, to_host_);
  }
}

std::size_t SerialLine::read(std::span<std::uint8_t> bytes, States now) {
  std::size_t count = 0;
  while (count < bytes.size() && readable(now)) {
    bytes[count++] = to_host_.front().value;
    to_host_.pop_front();
  }
  return count;
}

bool SerialLine::readable(States now) const {
  return !to_host_.empty() && to_host_.front().at <= now;
}

}  // namespace kaz::sim
