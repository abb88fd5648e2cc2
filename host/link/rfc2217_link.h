// Link to a serial port on another machine by RFC 2217, with bit rate and modem lines.
// SPDX-License-Identifier: Apache-2.0
//
// Works with the servers `kaz serve-port`, ser2net and others. Framing errors are not transferred: the server
// only forwards the bytes that its port received.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "host/link/byte_stream.h"
#include "host/link/port_link.h"
#include "host/link/telnet.h"

namespace kaz::host {

class Rfc2217Link final : public PortLink {
 public:
  // Connects and sets the port to 8N1 at the rate in `address`, without flow control. Returns the errors of
  // connect_tcp. Also fails if the server does not support RFC 2217 (environment), or cannot set the rate
  // (usage). `interrupt` may be null; else it must outlive the link.
  static Result<std::unique_ptr<Rfc2217Link>> open(const PortAddress& address,
                                                   const Interrupt* interrupt = nullptr);

  std::string name() const override { return address_.name(); }
  Time byte_time() const override { return Time(10'000'000'000 / address_.baud); }
  // Sets the bit rate and waits for the server's confirmation.
  Result<void> set_baud(int baud) override;
  // Sets DTR first, then RTS. Fails (environment) if the server's port has no modem lines. RFC 2217 defines
  // no reply for a port without modem lines. `kaz serve-port` reports missing lines as always on. If the port
  // of `kaz serve-port` has no DTR, a call with `dtr` = false therefore fails. A call with `dtr` = true can
  // succeed. The same rule applies to RTS.
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
  // Reads until `deadline` or until bytes arrive. Returns whether bytes arrived. Fails (environment) if data_
  // exceeds 1 MiB because the other end floods the link.
  Result<bool> pump(Time deadline);
  // Sends `command` and returns the value in the server's reply; nullopt if no reply arrives within a second.
  Result<std::optional<std::uint32_t>> value_of(telnet::ComPort command,
                                                std::span<const std::uint8_t> data);

  PortAddress address_;
  const Interrupt* interrupt_;
  ByteStream stream_;
  telnet::Reader reader_;
  telnet::Options options_;
  std::deque<std::uint8_t> data_;  // bytes received during a wait for a reply; at most 1 MiB
  std::deque<telnet::Command> replies_;
  std::uint64_t dropped_ = 0;
};

}  // namespace kaz::host
