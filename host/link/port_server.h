// The serving end of tcp: and rfc2217: one client at a time reaches the port of this machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "host/link/byte_stream.h"
#include "host/link/port_link.h"
#include "host/link/telnet.h"
#include "shared/base/browser_guard.hpp"

namespace kaz::host {

// A link whose far end is whichever client is connected. Without one, what is written is dropped and
// nothing is read. A second client is disconnected at once; but if the first has not used the port yet (raw:
// sent no byte; RFC 2217: not agreed to option 44), the first one is. It never fails for good: a client that
// leaves is waited for. Without a descriptor for a client that waits, the server tries again every 100 ms.
//
// A client that begins like a web browser is disconnected (browser_guard.hpp). By RFC 2217 nothing reaches
// `board` before the client has agreed to telnet option 44: bytes before that are dropped, commands ignored.
// Nor do the board's bytes reach the client before.
//
// The order of a client's bytes and commands is kept. A command is obeyed by the first read() after the one
// that returned the last byte before it, so the caller writes what read() returned to `board` before it
// calls read() again, as LineBridge does. Rate and modem lines change once board.drained(); a client whose
// bytes the port does not send within 5 s is disconnected. What a client sent before it left reaches `board`,
// also where it left without reading what it was sent.
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
  // Readable also when a client comes. -1 while a command waits until the board's port is drained.
  int descriptor() const override { return command_ ? -1 : events_.get(); }
  bool has_unsent() const override {
    return stream_.has_unsent() || !data_.empty() || !wire_.empty() || command_;
  }
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;

 private:
  PortServer(PortLink& board, const Options& options);
  void accept_clients();
  void pause_accepting(Time now);
  void begin_client(Descriptor client, const std::string& peer);
  bool uses_port() const;
  void displace_client();
  void drop_client(std::string_view why);
  void send(std::span<const std::uint8_t> wire);
  Result<void> receive();
  void parse();
  void take_data();
  void obey(const telnet::Command& command);
  void set_port(const telnet::Command& command, std::vector<std::uint8_t>& wire);
  std::uint8_t control(std::uint8_t value);

  PortLink& board_;
  Options options_;
  std::string name_;
  std::uint16_t port_ = 0;
  Descriptor listener_, events_;
  bool listening_ = true;  // events_ watches listener_
  Time accept_from_{};     // not before this
  ByteStream stream_;
  bool leaving_ = false;  // the client takes no more bytes, but some of its own may be unread
  std::string peer_;
  BrowserGuard guard_{BrowserGuard::Peer::frames};
  telnet::Reader reader_;
  telnet::Options negotiation_;
  bool warned_ = false;                     // of bytes before option 44 was agreed to
  std::vector<std::uint8_t> wire_;          // of the client, not parsed yet
  std::vector<std::uint8_t> data_;          // parsed, not read yet
  std::optional<telnet::Command> command_;  // came after data_
  Time drain_by_{};                         // the board's port must be drained by then
  int baud_ = KZ_BAUD;
  // The system switches both on when it opens a port; one without the lines reports them as on always.
  bool dtr_ = true, rts_ = true;
};

}  // namespace kaz::host
