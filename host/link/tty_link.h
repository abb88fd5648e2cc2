// Link over a serial port or a pseudo-terminal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "host/link/byte_stream.h"
#include "host/link/port_link.h"
#include "host/link/serial_port.h"

namespace kaz::host {

class TtyLink final : public PortLink {
 public:
  // Errors: those of open_serial_port (serial_port.h). `interrupt` may be null; else it must
  // outlive the link, and makes `read` fail once it is requested. Deadlines are on WallClock's
  // scale.
  static Result<std::unique_ptr<TtyLink>> open(const std::string& path, int baud = 115200,
                                               const Interrupt* interrupt = nullptr);
  TtyLink(const TtyLink&) = delete;
  TtyLink& operator=(const TtyLink&) = delete;

  std::string name() const override { return path_; }
  Time byte_time() const override;
  Result<void> set_baud(int baud) override;
  // Error (environment): a pseudo-terminal has no such lines.
  Result<void> set_dtr_rts(bool dtr, bool rts) override;
  LowLatency low_latency() const override { return low_latency_; }
  int descriptor() const override { return stream_.descriptor(); }
  bool has_unsent() const override { return stream_.has_unsent(); }
  bool drained() const override;
  void purge(bool received, bool unsent) override;
  // Fails when the port is gone, or when it has taken no byte of the last 64 KB.
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  // A port that goes away during use (unplugged, or the simulator at its other end ended) is an
  // error that says so; every later call fails too, until
  // reopen() succeeds.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  // Opens the same adapter again, whatever its path is now (serial_identity.h), or the same path where it is
  // no USB adapter; fails as `open` does until it is there.
  Result<void> reopen() override;

 private:
  TtyLink(std::string path, int baud, const OpenPort& port, const Interrupt* interrupt);
  Result<std::string> path_now() const;

  std::string path_;
  std::string identity_;  // of the USB adapter; empty: none
  int baud_;
  LowLatency low_latency_;
  const Interrupt* interrupt_;
  ByteStream stream_;
};

}  // namespace kaz::host
