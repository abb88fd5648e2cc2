// State of a CAN network interface, as reported by the interface's driver.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace kaz::host {

struct CanState {
  bool up = false;
  // Carrier state as set by the driver. Not taken from ioctl(): the flag IFF_RUNNING there follows the driver
  // with a delay of up to a second (net/core/link_watch.c of the kernel), which is too late just after
  // `ip link set up`.
  bool carrier = true;
  // Controller state, an `enum can_state` of linux/can/netlink.h. Virtual interfaces have no controller.
  std::optional<std::uint32_t> controller;

  // Whether the controller is bus-off; without a controller state, whether the carrier is missing.
  bool bus_off() const;
};

// Queries rtnetlink(7). `index` is from if_nametoindex(). Empty if the interface is gone, or if a sandbox
// forbids the query.
std::optional<CanState> can_state(unsigned index);

}  // namespace kaz::host
