// The serving end of tcp: and rfc2217: one client at a time reaches the port of this machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/link/byte_stream.h"
#include "host/link/port_link.h"
#include "host/link/telnet.h"

namespace kaz::host {

// A link whose far end is whichever client is connected. Without one, what is written is dropped and
// nothing is read. A second client is disconnected at once. It never fails for good: a client that leaves
// is waited for.
class PortServer final : public PortLink {
 public:
  enum class Protocol { raw, rfc2217 };
  struct Options {
    std::string host = "127.0.0.1";
    std::uint16_t port = 0;  // 0: the kernel chooses
    Protocol protocol = Protocol::raw;
    const Interrupt* interrupt = nullptr;  // may be null; else it must outlive the server
    // One line for the user: a client came, left, was refused. Without newline.
    std::function<void(const std::string&)> report = [](const std::string&) {};
  };
  // `board` is the port that rates and modem lines of rfc2217 are for; it must outlive the server. Errors:
  // those of listen_tcp (tcp_socket.h).
  static Result<std::unique_ptr<PortServer>> open(PortLink& board, const Options& options);

  std::string name() const override { return name_; }  // as a client writes it
  std::uint16_t port() const { return port_; }
  bool has_client() const { return stream_.is_open(); }
  Result<void> set_dtr_rts(bool dtr, bool rts) override;
  LowLatency low_latency() const override { return LowLatency::network; }
  // Readable also when a client comes.
  int descriptor() const override { return events_.get(); }
  bool has_unsent() const override { return stream_.has_unsent(); }
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;

 private:
  PortServer(PortLink& board, const Options& options);
  void accept_clients();
  void drop_client(const std::string& why);
  Result<void> take(std::span<const std::uint8_t> wire);
  void obey(const telnet::Command& command, std::vector<std::uint8_t>& wire);
  std::uint8_t control(std::uint8_t value);

  PortLink& board_;
  Options options_;
  std::string name_;
  std::uint16_t port_ = 0;
  Descriptor listener_, events_;
  ByteStream stream_;
  std::string peer_;
  telnet::Reader reader_;
  telnet::Options negotiation_;
  std::vector<std::uint8_t> data_;  // of the client, not read yet
  int baud_ = KZ_BAUD;
  bool dtr_ = false, rts_ = false;
};

}  // namespace kaz::host
