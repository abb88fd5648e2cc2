// For tests: pairs of SOCK_SEQPACKET sockets that replace CAN sockets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/can.h>
#include <linux/can/error.h>
#include <sys/socket.h>

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/link/can_sockets.h"

namespace kaz::host {

// The bus side of each channel.
struct TestBus {
  // Remote ends of the socket pairs, indexed by the identifier on which the link sends.
  std::map<std::uint32_t, Descriptor> far;
  std::map<std::uint32_t, IsoTpChannel> opened;
  Descriptor errors;
  std::optional<Error> state;  // if set, error that check() returns

  // Sends an error frame to the link. Returns false if the socket does not accept the frame.
  bool error_frame(std::uint32_t classes, std::uint8_t controller = 0) {
    can_frame frame{};
    frame.can_id = CAN_ERR_FLAG | classes;
    frame.can_dlc = CAN_ERR_DLC;
    frame.data[1] = controller;
    return send(errors.get(), &frame, sizeof frame, MSG_DONTWAIT | MSG_NOSIGNAL) ==
           static_cast<ssize_t>(sizeof frame);
  }
  // Sends a message to the link on channel `id`. Returns false if the socket does not accept the message.
  bool deliver(std::uint32_t id, std::span<const std::uint8_t> message) {
    return send(far[id].get(), message.data(), message.size(), MSG_DONTWAIT | MSG_NOSIGNAL) ==
           static_cast<ssize_t>(message.size());
  }
  // Returns the next message that the link sent on `id`; empty if no message came.
  std::vector<std::uint8_t> received(std::uint32_t id) {
    std::vector<std::uint8_t> bytes(5000);
    const ssize_t n = recv(far[id].get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return bytes;
  }
};

class TestCanSockets final : public CanSockets {
 public:
  explicit TestCanSockets(TestBus& bus) : bus_(bus) {}
  std::string interface() const override { return "can7"; }
  Result<void> check() override {
    if (bus_.state) return tl::unexpected(*bus_.state);
    return {};
  }
  Result<Descriptor> open_isotp(const IsoTpChannel& channel) override {
    bus_.opened[channel.tx_id] = channel;
    return pair(bus_.far[channel.tx_id]);
  }
  Result<Descriptor> open_errors() override { return pair(bus_.errors); }

 private:
  static Result<Descriptor> pair(Descriptor& far) {
    int both[2] = {-1, -1};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, both) != 0)
      return fail(Fault::environment, "no pair of sockets");
    far = Descriptor(both[1]);
    return Descriptor(both[0]);
  }
  TestBus& bus_;
};

}  // namespace kaz::host
