// A port at which servos are, as a link to a board.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/bus_port.h"

#include <algorithm>
#include <array>

#include "shared/base/counted.hpp"

namespace kaz::host {

Result<std::unique_ptr<BusPort>> BusPort::open(std::unique_ptr<PortLink> port,
                                               std::vector<BusJoint> joints,
                                               const Interrupt* interrupt) {
  std::unique_ptr<BusPort> opened(new BusPort(std::move(port), interrupt));
  opened->board_ = std::make_unique<BusBoard>(
      KAZ_TRY(BusBoard::open(*opened->port_, opened->clock_, std::move(joints))));
  return opened;
}

Result<void> BusPort::write(std::span<const std::uint8_t> bytes) {
  board_->take(bytes);
  // At once: a program that ends sends an off and reads no reply.
  if (!board_->off_is_next()) return {};
  const auto answer = KAZ_TRY(board_->serve());
  if (answer) answer_.insert(answer_.end(), answer->begin(), answer->end());
  return {};
}

Result<std::size_t> BusPort::read(std::span<std::uint8_t> bytes, Time deadline) {
  while (answer_.empty()) {
    const auto answer = KAZ_TRY(board_->serve());
    if (answer) {
      answer_ = *answer;
      continue;
    }
    // Nothing is asked: whatever comes is noise, or the port is gone.
    std::array<std::uint8_t, 64> noise{};
    KAZ_TRY(port_->read(noise, deadline));
    if (clock_.now() >= deadline) return std::size_t{0};
  }
  const std::size_t count = std::min(bytes.size(), answer_.size());
  std::copy_n(answer_.begin(), count, bytes.begin());
  answer_.erase(answer_.begin(), answer_.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

Result<void> BusPort::reopen() {
  KAZ_TRY(port_->reopen());
  board_->forget();
  answer_.clear();
  return {};
}

std::string BusPort::counts() const {
  const BusDriver::Counts& counts = board_->counts();
  if (counts.missing + counts.damaged == 0) return "";
  return std::to_string(counts.missing) + " of " + counted(counts.requests, "request") +
         " without an answer, " + counted(counts.damaged, "answer") + " damaged";
}

}  // namespace kaz::host
