// Link over a TCP connection that transfers raw bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/link/byte_stream.h"
#include "host/link/port_link.h"

namespace kaz::host {

class TcpLink final : public PortLink {
 public:
  // Fails with the same errors as connect_tcp() (tcp_socket.h). `interrupt` may be null; else it must outlive
  // the link.
  static Result<std::unique_ptr<TcpLink>> open(const PortAddress& address,
                                               const Interrupt* interrupt = nullptr);

  std::string name() const override { return address_.name(); }
  // Always fails (environment), because only RFC 2217 transfers modem lines.
  Result<void> set_dtr_rts(bool dtr, bool rts) override;
  LowLatency low_latency() const override { return LowLatency::network; }
  int descriptor() const override { return stream_.descriptor(); }
  bool has_unsent() const override { return stream_.has_unsent(); }
  Result<void> write(std::span<const std::uint8_t> bytes) override { return stream_.write(bytes); }
  // Fails with the same errors as ByteStream::read(). Also fails (environment) if the first bytes from the
  // other end are telnet commands.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  Result<void> reopen() override;

 private:
  TcpLink(PortAddress address, const Interrupt* interrupt);

  PortAddress address_;
  const Interrupt* interrupt_;
  ByteStream stream_;
  std::vector<std::uint8_t> first_;  // first bytes of this connection, to detect a telnet server
};

}  // namespace kaz::host
