// Link to a serial port on another machine by RFC 2217: rate, parity and modem lines cross too.
// SPDX-License-Identifier: Apache-2.0
//
// Servers: `kaz serve-port`, ser2net, and others. Framing errors do not cross: the server passes on what its
// port received.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/link/byte_stream.h"
#include "host/link/port_link.h"
#include "host/link/telnet.h"

namespace kaz::host {

class Rfc2217Link final : public PortLink {
 public:
  // Connects, and sets the port to 8N1 at the address's rate without handshake. Errors: those of connect_tcp;
  // what serves that port does not speak RFC 2217; it cannot set the rate. `interrupt` may be null; else it
  // must outlive the link.
  static Result<std::unique_ptr<Rfc2217Link>> open(const PortAddress& address,
                                                   const Interrupt* interrupt = nullptr);

  std::string name() const override { return address_.name(); }
  Time byte_time() const override { return Time(10'000'000'000 / address_.baud); }
  // Returns when the server has set it.
  Result<void> set_baud(int baud) override;
  // DTR first, then RTS; both leave in one piece. Error (environment): the server's port has no such lines.
  // RFC 2217 has no reply for that. `kaz serve-port` reports such lines as always on, so the error comes with
  // the first line that is to be off.
  Result<void> set_dtr_rts(bool dtr, bool rts) override;
  LowLatency low_latency() const override { return LowLatency::network; }
  int descriptor() const override { return stream_.descriptor(); }
  bool has_unsent() const override { return stream_.has_unsent() || !data_.empty(); }
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  Result<void> reopen() override;
  std::string counts() const override;

 private:
  Rfc2217Link(PortAddress address, const Interrupt* interrupt);
  Result<void> begin(Time patience);
  Result<void> set_up();
  // Reads what is there until `deadline` or until something came. Error (environment): data_ would exceed
  // its limit, because the other end floods the link.
  Result<bool> pump(Time deadline);
  // The value in the server's reply to `command`; nothing if none comes within a second.
  Result<std::optional<std::uint32_t>> value_of(telnet::ComPort command,
                                                std::span<const std::uint8_t> data);

  PortAddress address_;
  const Interrupt* interrupt_;
  ByteStream stream_;
  telnet::Reader reader_;
  telnet::Options options_;
  std::deque<std::uint8_t> data_;  // received while a command was answered; at most 1 MiB
  std::deque<telnet::Command> replies_;
  std::uint64_t dropped_ = 0;
};

}  // namespace kaz::host
