// State of a CAN network interface, as its driver reports it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace kaz::host {

struct CanState {
  bool up = false;
  // As the driver sets it. IFF_RUNNING, as ioctl() reports it, follows up to a second later
  // (net/core/link_watch.c of the kernel). That is too late just after `ip link set up`.
  bool carrier = true;
  // `enum can_state` of linux/can/netlink.h. Virtual interfaces have no controller state.
  std::optional<std::uint32_t> controller;

  // Whether the controller is bus-off; without a controller state, whether the carrier is missing.
  bool bus_off() const;
};

// Queries rtnetlink(7). `index` is from if_nametoindex(). Empty if the interface is gone, or if a sandbox
// forbids the query.
std::optional<CanState> can_state(unsigned index);

}  // namespace kaz::host
