// Waits for either side, carries what came, and looks for a side that is gone.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/line_bridge.h"

#include <poll.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "host/link/wall_clock.h"

namespace kaz::host {

namespace {

constexpr Time kBetweenTries = std::chrono::milliseconds(50);
constexpr int kUnsentWait_ms = 1, kIdleWait_ms = 100;

bool ends(const Error& error) {
  return error.fault == Fault::interrupted || error.fault == Fault::usage;
}

}  // namespace

LineBridge::LineBridge(PortLink& board, PortLink& far, const Interrupt& interrupt, Report report)
    : board_{board}, far_{far}, interrupt_(interrupt), report_(std::move(report)) {}

Result<void> LineBridge::run() {
  while (!interrupt_.ends_waiting()) {
    auto done = wait();
    for (auto [from, to] : {std::pair(&board_, &far_), std::pair(&far_, &board_)}) {
      if (done) done = from->there ? carry(*from, *to) : seek(*from);
    }
    if (!done && done.error().fault == Fault::interrupted) return {};
    KAZ_TRY(done);
  }
  return {};
}

Result<void> LineBridge::wait() {
  const auto descriptor = [](const Side& side) { return side.there ? side.link.descriptor() : -1; };
  std::array<pollfd, 3> watched = {{{descriptor(board_), POLLIN, 0},
                                    {descriptor(far_), POLLIN, 0},
                                    {interrupt_.descriptor(), POLLIN, 0}}};
  const bool unsent = (board_.there && board_.link.has_unsent()) ||
                      (far_.there && far_.link.has_unsent()) || !board_.there || !far_.there;
  poll(watched.data(), watched.size(), unsent ? kUnsentWait_ms : kIdleWait_ms);
  return {};
}

Result<void> LineBridge::carry(Side& from, Side& to) {
  std::array<std::uint8_t, 4096> bytes;
  const auto count = from.link.read(bytes, WallClock().now());
  if (!count) return lose(from, count.error());
  if (*count == 0) return {};
  if (!to.there) {
    to.dropped += *count;
    return {};
  }
  if (auto written = to.link.write(std::span(bytes).first(*count)); !written) {
    to.dropped += *count;
    return lose(to, written.error());
  }
  to.taken += *count;
  return {};
}

Result<void> LineBridge::lose(Side& side, const Error& error) {
  if (ends(error)) return tl::unexpected(error);
  side.there = false;
  side.lost = WallClock().now();
  side.next_try = side.lost + kBetweenTries;
  report_(error.message);
  return {};
}

Result<void> LineBridge::seek(Side& side) {
  const Time now = WallClock().now();
  if (now < side.next_try) return {};
  side.next_try = now + kBetweenTries;
  if (auto opened = side.link.reopen(); !opened)
    return ends(opened.error()) ? opened : Result<void>();
  side.there = true;
  char text[64];
  std::snprintf(text, sizeof text, " is available again after %.1f s", seconds(now - side.lost));
  report_(side.link.name() + text);
  return {};
}

std::string LineBridge::counts() const {
  return std::to_string(board_.taken) + " bytes to the board, " + std::to_string(far_.taken) +
         " back, " + std::to_string(board_.dropped + far_.dropped) + " dropped";
}

}  // namespace kaz::host
