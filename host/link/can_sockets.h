// Sockets of one CAN interface: the kernel's, or a test's.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"

namespace kaz::host {

// One direction pair of ISO-TP (ISO 15765-2, normal addressing, 11-bit identifiers).
struct IsoTpChannel {
  enum class Mode {
    pair,       // sends on tx_id, receives on rx_id; both carry flow control for the other
    broadcast,  // sends only, to any number of receivers, without flow control
    listen,     // receives such a broadcast
  };
  std::uint32_t tx_id = 0, rx_id = 0;
  Mode mode = Mode::pair;
};

// Sockets are non-blocking and have the semantics of SOCK_SEQPACKET: one message per read and write.
class CanSockets {
 public:
  virtual ~CanSockets() = default;
  virtual std::string interface() const = 0;
  // Whether the interface carries frames now. Errors (environment), one sentence each with the command that
  // mends it: no such interface, no CAN interface, down, bus-off.
  virtual Result<void> check() = 0;
  // ISO-TP by the kernel: a message is what one frame of the board's line carries. Errors (environment): no
  // module, the identifiers are in use by another program.
  virtual Result<Descriptor> open_isotp(const IsoTpChannel& channel) = 0;
  // Error frames alone: messages are struct can_frame with CAN_ERR_FLAG (linux/can/error.h).
  virtual Result<Descriptor> open_errors() = 0;
};

// SocketCAN. The interface need not exist yet; check() says whether it does.
std::unique_ptr<CanSockets> kernel_can_sockets(const std::string& interface);

}  // namespace kaz::host
