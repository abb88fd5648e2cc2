// Link over a serial port or a pseudo-terminal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/link/interrupt.h"
#include "host/link/link.h"
#include "host/link/modem_lines.h"
#include "host/link/serial_port.h"

namespace kaz::host {

class TtyLink final : public Link, public ModemLines {
 public:
  // Errors: those of open_serial_port (serial_port.h). `interrupt` may be null; else it must
  // outlive the link, and makes `read` fail once it is requested. Deadlines are on WallClock's
  // scale.
  static Result<std::unique_ptr<TtyLink>> open(const std::string& path, int baud = 115200,
                                               const Interrupt* interrupt = nullptr);
  ~TtyLink() override;
  TtyLink(const TtyLink&) = delete;
  TtyLink& operator=(const TtyLink&) = delete;

  std::string name() const override { return path_; }
  Time byte_time() const override;
  Result<void> set_baud(int baud) override;
  // Error (environment): a pseudo-terminal has no such lines.
  Result<void> set_dtr_rts(bool dtr, bool rts) override;
  LowLatency low_latency() const { return low_latency_; }
  // Fails when the port is gone, or when it has taken no byte of the last 64 KB.
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  // A port that goes away during use (unplugged, or the simulator at its other end ended) is an
  // error that says so; every later call fails too, until
  // reopen() succeeds.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  // Opens the same path again; fails as `open` does until it is there.
  Result<void> reopen() override;

 private:
  TtyLink(std::string path, int baud, const OpenPort& port, const Interrupt* interrupt);
  Result<void> flush();
  Error closed() const;

  std::string path_;
  int baud_;
  int fd_;
  LowLatency low_latency_;
  const Interrupt* interrupt_;
  std::vector<std::uint8_t> pending_;  // what the port has not taken yet
};

}  // namespace kaz::host
