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
  // Fails with the same errors as open_serial_port() (serial_port.h). `interrupt` may be null. If `interrupt`
  // is not null, it must outlive the link, and an interrupt request makes `read` fail. Deadlines are on
  // WallClock's scale.
  static Result<std::unique_ptr<TtyLink>> open(const std::string& path, int baud = 115200,
                                               const Interrupt* interrupt = nullptr);
  TtyLink(const TtyLink&) = delete;
  TtyLink& operator=(const TtyLink&) = delete;

  std::string name() const override { return path_; }
  Time byte_time() const override;
  Result<void> set_baud(int baud) override;
  // Fails (environment) if the port has no modem lines. For example, a pseudo-terminal has no modem lines.
  Result<void> set_dtr_rts(bool dtr, bool rts) override;
  LowLatency low_latency() const override { return low_latency_; }
  int descriptor() const override { return stream_.descriptor(); }
  bool has_unsent() const override { return stream_.has_unsent(); }
  bool drained() const override;
  void purge(bool received, bool unsent) override;
  // Fails if the port is lost. Also fails if `bytes` and the bytes that are still unsent exceed 64 KiB
  // together.
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  // Fails if the port disappears during use (adapter unplugged, or the simulator at the other end has ended).
  // After such a failure, every call fails until reopen() succeeds.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  // Opens the same USB adapter again, even if its path has changed (serial_identity.h). If the port has no
  // USB adapter, opens the old path again. While the port is missing, fails (environment).
  Result<void> reopen() override;

 private:
  TtyLink(std::string path, int baud, const OpenPort& port, const Interrupt* interrupt);
  Result<std::string> path_now() const;

  std::string path_;
  std::string identity_;  // identity of the USB adapter; empty if the port has no USB adapter
  int baud_;
  LowLatency low_latency_;
  const Interrupt* interrupt_;
  ByteStream stream_;
};

}  // namespace kaz::host
