// Modifies frames from the board.
// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/bench/rewriting_link_testing.h"

#include <algorithm>
#include <array>

namespace kaz::hil {

RewritingLink::RewritingLink(host::Link& link, Change change)
    : link_(link), change_(std::move(change)) {
  kz_receiver_init(&receiver_);
}

Result<std::size_t> RewritingLink::read(std::span<std::uint8_t> bytes, Time deadline) {
  while (changed_.empty()) {
    std::array<std::uint8_t, 64> buffer;
    const auto count = link_.read(buffer, deadline);
    if (!count || *count == 0) return count;
    for (std::size_t i = 0; i < *count; ++i) take(buffer[i]);
  }
  const std::size_t count = std::min(bytes.size(), changed_.size());
  const auto end = changed_.begin() + static_cast<std::ptrdiff_t>(count);
  std::copy(changed_.begin(), end, bytes.begin());
  changed_.erase(changed_.begin(), end);
  return count;
}

void RewritingLink::take(std::uint8_t byte) {
  if (kz_receive(&receiver_, byte, 0) != KZ_RECEIVE_FRAME) return;
  Body body(receiver_.body, receiver_.body + receiver_.length);
  change_(body);
  if (body.empty()) return;
  std::array<std::uint8_t, KZ_FRAME_MAX> wire;
  const auto length = kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data());
  changed_.insert(changed_.end(), wire.begin(), wire.begin() + length);
}

}  // namespace kaz::hil
