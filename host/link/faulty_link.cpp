// Faults of the line between a host and its port.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/faulty_link.h"

#include <algorithm>
#include <array>

namespace kaz::host {

FaultyLink::FaultyLink(Link& link, Clock& clock, faults::Schedule schedule, std::uint64_t seed)
    : link_(link),
      clock_(clock),
      schedule_(std::move(schedule)),
      start_(clock.now()),
      to_board_(seed, faults::Way::to_board),
      to_host_(seed, faults::Way::to_host) {}

void FaultyLink::pass(faults::LinkFaults& faults, std::uint8_t value, std::deque<Late>& to) {
  const Time now = clock_.now();
  const auto out = faults.pass(schedule_, now - start_, {value, false});
  Time due = now + out.delay;
  if (!to.empty()) due = std::max(due, to.back().due);
  for (std::size_t i = 0; i < out.count; ++i) to.push_back({due, out.bytes[i].value});
}

Result<void> FaultyLink::flush() {
  std::vector<std::uint8_t> bytes;
  while (!for_board_.empty() && for_board_.front().due <= clock_.now()) {
    bytes.push_back(for_board_.front().value);
    for_board_.pop_front();
  }
  if (bytes.empty()) return {};
  return link_.write(bytes);
}

Result<void> FaultyLink::write(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t value : bytes) pass(to_board_, value, for_board_);
  return flush();
}

std::size_t FaultyLink::take(std::span<std::uint8_t> bytes) {
  std::size_t count = 0;
  while (count < bytes.size() && !for_host_.empty() && for_host_.front().due <= clock_.now()) {
    bytes[count++] = for_host_.front().value;
    for_host_.pop_front();
  }
  return count;
}

Result<std::size_t> FaultyLink::read(std::span<std::uint8_t> bytes, Time deadline) {
  std::array<std::uint8_t, 256> buffer{};
  while (true) {
    KAZ_TRY(flush());
    if (const std::size_t count = take(bytes); count > 0) return count;
    Time until = deadline;
    if (!for_board_.empty()) until = std::min(until, for_board_.front().due);
    if (!for_host_.empty()) until = std::min(until, for_host_.front().due);
    const auto got = link_.read(buffer, until);
    if (!got) return got;
    for (std::size_t i = 0; i < *got; ++i) pass(to_host_, buffer[i], for_host_);
    if (*got == 0 && clock_.now() >= deadline) {
      KAZ_TRY(flush());
      return take(bytes);
    }
  }
}

}  // namespace kaz::host
