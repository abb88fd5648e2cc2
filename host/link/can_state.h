// State of a network interface as its driver knows it now.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace kaz::host {

struct CanState {
  bool up = false;
  // What the driver has set. IFF_RUNNING, of ioctl(), follows it up to a second later
  // (net/core/link_watch.c of the kernel): too late just after `ip link set up`.
  bool carrier = true;
  std::optional<std::uint32_t>
      controller;  // can_state of linux/can/netlink.h; virtual ones have none

  bool bus_off() const;
};

// By rtnetlink(7); `index` as if_nametoindex() returns it. Empty where the interface is gone or a sandbox
// forbids the question.
std::optional<CanState> can_state(unsigned index);

}  // namespace kaz::host
