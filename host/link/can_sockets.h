// Sockets of one CAN interface, provided by the kernel or by a test.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"

namespace kaz::host {

// A pair of identifiers of ISO-TP (ISO 15765-2, normal addressing, 11 bits).
struct IsoTpChannel {
  enum class Mode {
    // Sends messages with tx_id, receives messages with rx_id. The flow control for sent messages arrives
    // with rx_id. The flow control for received messages is sent with tx_id.
    pair,
    broadcast,  // sends only, to any number of receivers, without flow control
    listen,     // receives the messages of a `broadcast` channel
  };
  std::uint32_t tx_id = 0, rx_id = 0;
  Mode mode = Mode::pair;
};

// Opens the sockets of one interface. Sockets are non-blocking and behave like sockets of type
// SOCK_SEQPACKET: each read or write transfers one message.
class CanSockets {
 public:
  virtual ~CanSockets() = default;
  virtual std::string interface() const = 0;
  // Succeeds if the interface carries frames now. Fails (environment) if the interface does not exist, is not
  // CAN, is down, or is bus-off. The error message contains the command that repairs the interface.
  virtual Result<void> check() = 0;
  // Opens an ISO-TP socket of the kernel. One message is one frame of the wire protocol. Fails (environment)
  // if the kernel module is missing, or if another program uses the identifiers.
  virtual Result<Descriptor> open_isotp(const IsoTpChannel& channel) = 0;
  // Opens a socket that receives error frames only, as struct can_frame with CAN_ERR_FLAG
  // (linux/can/error.h).
  virtual Result<Descriptor> open_errors() = 0;
};

// Returns sockets of the kernel (SocketCAN). The interface need not exist yet; check() reports a missing
// interface.
std::unique_ptr<CanSockets> kernel_can_sockets(const std::string& interface);

}  // namespace kaz::host
