// Server that gives one client at a time (tcp: or rfc2217:) access to a port of this machine.
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

// A link to the currently connected client. As long as there is no client, written bytes are dropped and no
// bytes are read. If a second client connects after the first client has used the port, the second client is
// disconnected at once. If the first client has not used the port yet, the second client replaces the first
// client. A raw client has used the port as soon as its first byte has arrived. An RFC 2217 client has used
// the port as soon as the client has agreed to option 44. The link never fails permanently: when a client
// leaves, the link waits for the next client. If no descriptor is free for a waiting client, the server
// retries every 100 ms.
//
// A client is disconnected if its first bytes could come from a web browser (browser_guard.hpp). With RFC
// 2217, no byte passes in either direction before the client has agreed to telnet option 44. Before this
// agreement, the client's bytes are dropped and the client's commands are ignored.
//
// A client's bytes and commands stay in order. read() first returns all bytes that precede a command; the
// next read() executes the command. So after each read(), the caller must forward the bytes to `board`, and
// only then call read() again. LineBridge follows this order. The server changes the bit rate and the modem
// lines only after board.drained() has returned true. If the port does not send a client's bytes within 5 s,
// the server disconnects the client. All bytes that a client sent before it left are forwarded to `board`.
// This also applies to a client that left without reading its received bytes.
class PortServer final : public PortLink {
 public:
  enum class Protocol { raw, rfc2217 };
  struct Options {
    std::string host = "127.0.0.1";
    std::uint16_t port = 0;  // 0: the kernel selects the port
    Protocol protocol = Protocol::raw;
    const Interrupt* interrupt = nullptr;  // may be null; else it must outlive the server
    // Callback that gets one line for the user, without newline, when a client connects, leaves or is
    // rejected.
    std::function<void(const std::string&)> report = [](const std::string&) {};
  };
  // `board` receives the bit rates and modem lines of RFC 2217 and must outlive the server. Returns the
  // errors of listen_tcp (tcp_socket.h).
  static Result<std::unique_ptr<PortServer>> open(PortLink& board, const Options& options);

  std::string name() const override { return name_; }  // address to which clients connect
  std::uint16_t port() const { return port_; }
  bool has_client() const { return stream_.is_open(); }
  Result<void> set_dtr_rts(bool dtr, bool rts) override;
  LowLatency low_latency() const override { return LowLatency::network; }
  // The descriptor also becomes readable when a client connects. A client's command waits until the board's
  // port has sent all bytes. While a command waits, descriptor() returns -1.
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
  bool listening_ = true;  // true: events_ watches listener_
  Time accept_from_{};     // time before which no client is accepted
  ByteStream stream_;
  // True: a write to the client failed, so nothing more is written. Bytes from the client may still be
  // unread.
  bool leaving_ = false;
  std::string peer_;
  BrowserGuard guard_{BrowserGuard::Peer::frames};
  telnet::Reader reader_;
  telnet::Options negotiation_;
  // True: report() has announced that bytes came before the agreement to telnet option 44.
  bool warned_ = false;
  std::vector<std::uint8_t> wire_;          // bytes from the client that are not parsed yet
  std::vector<std::uint8_t> data_;          // parsed bytes that read() has not returned yet
  std::optional<telnet::Command> command_;  // command that came after the bytes in data_
  Time drain_by_{};                         // time by which the board's port must be drained
  int baud_ = KZ_BAUD;
  // The operating system activates both lines when a port is opened. A port without these lines reports both
  // lines as always on.
  bool dtr_ = true, rts_ = true;
};

}  // namespace kaz::host
