// Link over a TCP connection: bytes as they are.
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
  // Errors: those of connect_tcp (tcp_socket.h). `interrupt` may be null; else it must outlive the link.
  static Result<std::unique_ptr<TcpLink>> open(const PortAddress& address,
                                               const Interrupt* interrupt = nullptr);

  std::string name() const override { return address_.name(); }
  // Error (environment): bytes alone cross; rfc2217 has the lines.
  Result<void> set_dtr_rts(bool dtr, bool rts) override;
  LowLatency low_latency() const override { return LowLatency::network; }
  int descriptor() const override { return stream_.descriptor(); }
  bool has_unsent() const override { return stream_.has_unsent(); }
  Result<void> write(std::span<const std::uint8_t> bytes) override { return stream_.write(bytes); }
  // Besides those of ByteStream: an error (environment) if the other end's first bytes are Telnet's.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  Result<void> reopen() override;

 private:
  TcpLink(PortAddress address, const Interrupt* interrupt);

  PortAddress address_;
  const Interrupt* interrupt_;
  ByteStream stream_;
  std::vector<std::uint8_t> first_;  // bytes of this connection, until it is known whose they are
};

}  // namespace kaz::host
