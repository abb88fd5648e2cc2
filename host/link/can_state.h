// State of a CAN network interface, as reported by the interface's driver.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace kaz::host {

struct CanState {
  bool up = false;
  // Carrier state as set by the driver. The state does not come from ioctl(). The flag IFF_RUNNING of ioctl()
  // follows the driver with a delay of up to a second (net/core/link_watch.c of the kernel). Just after `ip
  // link set up`, IFF_RUNNING still has the old value.
  bool carrier = true;
  // Controller state, an `enum can_state` of linux/can/netlink.h. Virtual interfaces have no controller.
  std::optional<std::uint32_t> controller;

  // Returns whether the controller is bus-off. An interface without a controller counts as bus-off if it has
  // no carrier.
  bool bus_off() const;
};

// Queries rtnetlink(7). `index` is from if_nametoindex(). The result is empty if the interface is gone, or if
// a sandbox forbids the query.
std::optional<CanState> can_state(unsigned index);

}  // namespace kaz::host
