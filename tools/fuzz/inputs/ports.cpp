// Ports on a network: a hostile client at `kaz serve-port`, and a hostile server of RFC 2217 at the host.
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <thread>
#include <vector>

#include "hil/fuzz/choices.h"
#include "host/link/port_server.h"
#include "host/link/rfc2217_link.h"
#include "host/link/tcp_socket.h"
#include "host/link/wall_clock.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"

namespace kaz::fuzz {
namespace {

using namespace host::telnet;
using hil::fuzz::Choices;
using Wire = std::vector<std::uint8_t>;

// What reaches a board, in order; bytes that follow one another are one entry.
struct Log {
  std::vector<std::string> entries;
  void data(Bytes bytes) {
    if (bytes.empty()) return;
    if (entries.empty() || entries.back()[0] != 'd') entries.emplace_back("d");
    entries.back().append(bytes.begin(), bytes.end());
  }
  void baud(int baud) { entries.push_back("baud " + std::to_string(baud)); }
  void lines(bool dtr, bool rts) {
    entries.push_back("lines " + std::to_string(dtr) + std::to_string(rts));
  }
  void purge(bool received, bool unsent) {
    entries.push_back("purge " + std::to_string(received) + std::to_string(unsent));
  }
};

struct LoggedPort final : host::PortLink {
  std::string name() const override { return "the port"; }
  host::LowLatency low_latency() const override { return host::LowLatency::set; }
  int descriptor() const override { return -1; }
  Result<std::size_t> read(std::span<std::uint8_t>, Time) override { return 0; }
  Result<void> write(Bytes bytes) override {
    log.data(bytes);
    return {};
  }
  Result<void> set_baud(int baud) override {
    log.baud(baud);
    return {};
  }
  Result<void> set_dtr_rts(bool dtr, bool rts) override {
    log.lines(dtr, rts);
    return {};
  }
  void purge(bool received, bool unsent) override { log.purge(received, unsent); }
  Log log;
};

// HTTP begins with text, TLS with 22.
bool is_browser(const Wire& wire) {
  return !wire.empty() &&
         (std::isprint(wire.front()) || std::isspace(wire.front()) || wire.front() == 22);
}

// What has to reach the board of all that a client of RFC 2217 has sent.
Log expected_log(const Wire& wire) {
  Log log;
  Reader reader;
  Bytes left = wire;
  bool agreed = false, dtr = true, rts = true;
  while (!left.empty()) {
    const auto command = reader.take(left);
    const auto data = reader.take_data();
    if (agreed) log.data(data);
    if (!command) continue;
    if (command->verb != kSb) {
      agreed =
          agreed || (command->what == kComPort && (command->verb == kWill || command->verb == kDo));
    } else if (agreed) {
      const int value = command->data.empty() ? 0 : command->data.front();
      const std::uint32_t baud = read_big_endian(command->data);
      if (command->what == kBaudRate && baud > 0 && baud <= 4'000'000)
        log.baud(static_cast<int>(baud));
      if (command->what == kPurge) log.purge((value & 1) != 0, (value & 2) != 0);
      const bool line = value == kDtrOn || value == kDtrOff || value == kRtsOn || value == kRtsOff;
      if (command->what != kControl || !line) continue;
      if (value <= kDtrOff) dtr = value == kDtrOn;
      if (value >= kRtsOn) rts = value == kRtsOn;
      log.lines(dtr, rts);
    }
  }
  return log;
}

Descriptor client_of(std::uint16_t port) {
  Descriptor client(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(port);
  // Closing resets the connection: thousands of cases a second would use up all ports (TIME-WAIT).
  const linger reset{1, 0};
  ::setsockopt(client.get(), SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
  const int on = 1;
  ::setsockopt(client.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  while (::connect(client.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
    if (errno != EINTR) return {};
  return client;
}

// False: the other end has closed. Loopback has delivered what has been sent; not what is acknowledged, which
// takes up to 40 ms.
bool send_all(int socket, Bytes bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  for (int unsent = 1; ::ioctl(socket, SIOCOUTQNSD, &unsent) == 0 && unsent > 0;)
    std::this_thread::yield();
  return true;
}

// As LineBridge does, until there is nothing to do.
bool serve(host::PortServer& server, LoggedPort& port) {
  std::array<std::uint8_t, 300> bytes;
  for (int idle = 0; idle < 3; ++idle) {
    const auto count = server.read(bytes, host::WallClock().now());
    if (!count || !port.write(std::span(bytes).first(*count))) return false;
    if (*count > 0 || server.has_unsent()) idle = -1;
  }
  return true;
}

Wire received(int socket) {
  Wire all;
  std::array<std::uint8_t, 4096> some;
  for (ssize_t n = 0; (n = ::recv(socket, some.data(), some.size(), MSG_DONTWAIT)) > 0;)
    all.insert(all.end(), some.begin(), some.begin() + n);
  return all;
}

// A client that keeps the protocol is served after whatever came before.
Complaint judge_service(host::PortServer& server, LoggedPort& port, const Descriptor& client) {
  (void)received(client.get());
  Wire wire{kIac, kSe, kIac, kSe};
  put_option(kWill, kComPort, wire);
  put_com_port(kBaudRate, big_endian(57600), wire);
  Wire every(256);
  for (std::size_t i = 0; i < every.size(); ++i) every[i] = static_cast<std::uint8_t>(i);
  if (!send_all(client.get(), wire) || !serve(server, port) || !server.write(every))
    return "a client that keeps the protocol is not served";
  if (port.log.entries.empty() || port.log.entries.back() != "baud 57600")
    return "the port did not receive the baud rate";
  const Wire answer = received(client.get());
  Bytes left = answer;
  Reader reader;
  bool answered = false;
  while (const auto command = reader.take(left)) {
    answered = command->verb == kSb && command->what == kBaudRate + kReply &&
               read_big_endian(command->data) == 57600;
    (void)reader.take_data();
  }
  if (!answered) return "the server did not confirm the baud rate";
  if (reader.take_data() != every) return "the client received other bytes than the board sent";
  return std::nullopt;
}

// Sends all of `bytes` to one client, then the end, and reads what the client sends until it closes.
class HostileServer {
 public:
  HostileServer(int listener, Bytes bytes)
      : thread_([listener, bytes] {
          pollfd waiting{listener, POLLIN, 0};
          ::poll(&waiting, 1, 5000);
          const Descriptor client(::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC));
          (void)send_all(client.get(), bytes);
          ::shutdown(client.get(), SHUT_WR);
          std::array<std::uint8_t, 4096> ignored;
          while (::recv(client.get(), ignored.data(), ignored.size(), 0) > 0) continue;
          const linger reset{1, 0};
          ::setsockopt(client.get(), SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
        }) {}
  ~HostileServer() { thread_.join(); }
  HostileServer(const HostileServer&) = delete;
  HostileServer& operator=(const HostileServer&) = delete;

 private:
  std::thread thread_;
};

Complaint judge_link_error(const Error& error, const std::string& name) {
  // The server's answer may also be that it cannot set the rate, which the user has chosen.
  const Fault fault = error.fault == Fault::usage ? Fault::usage : Fault::environment;
  return judge_error(error, name, fault);
}

}  // namespace

Complaint try_serve_port(Bytes bytes) {
  using Protocol = host::PortServer::Protocol;
  Choices choices(bytes);
  const Protocol protocol = choices.below(2) == 0 ? Protocol::rfc2217 : Protocol::raw;
  LoggedPort port;
  auto server = host::PortServer::open(port, {.protocol = protocol});
  if (!server) return server.error().message;
  const Descriptor client = client_of((*server)->port());
  // The connection is the kernel's: the case says nothing of the server then.
  if (!client) return std::string("cannot connect: ") + std::strerror(errno);
  Wire all;
  while (!choices.ended()) {  // segments
    Wire piece(choices.below(256) + 1u);
    for (std::uint8_t& byte : piece) byte = choices.byte();
    if (!send_all(client.get(), piece)) break;
    all.insert(all.end(), piece.begin(), piece.end());
    if (!serve(**server, port)) return "the server has failed";
    if (is_browser(all)) break;
  }
  if (!serve(**server, port)) return "the server has failed";
  Log expected;
  if (!is_browser(all)) {
    if (protocol == Protocol::raw) expected.data(all);
    if (protocol == Protocol::rfc2217) expected = expected_log(all);
  }
  if (port.log.entries != expected.entries)
    return "the port received other data than the client sent";
  if ((*server)->has_client() == is_browser(all))
    return is_browser(all) ? "a web browser was accepted as a client" : "a client was disconnected";
  if (protocol == Protocol::raw || is_browser(all)) return std::nullopt;
  return judge_service(**server, port, client);
}

Complaint try_rfc2217(Bytes bytes) {
  static const auto listener = host::listen_tcp("127.0.0.1", 0);
  if (!listener) return listener.error().message;
  Choices choices(bytes);
  const bool changes_rate = choices.below(2) == 1;
  const Bytes sent = bytes.subspan(std::min<std::size_t>(bytes.size(), 1));
  // listen_tcp() makes a socket that does not block; the server waits in poll().
  const HostileServer server(listener->get(), sent);
  const host::PortAddress address{host::PortKind::rfc2217, "127.0.0.1",
                                  host::port_of(listener->get())};
  const auto link = host::Rfc2217Link::open(address);
  if (!link) return judge_link_error(link.error(), address.name());
  if (changes_rate) {
    const auto set = (*link)->set_baud(57600);
    if (auto wrong = set ? Complaint() : judge_link_error(set.error(), address.name()))
      return wrong;
  }
  std::size_t count = 0;
  while (true) {
    std::array<std::uint8_t, 300> some;
    const auto came = (*link)->read(some, host::WallClock().now() + std::chrono::seconds(5));
    if (!came) return judge_link_error(came.error(), address.name());
    if (*came == 0) return "the end of the connection was not noticed";
    count += *came;
    if (count > sent.size()) return "more data bytes were returned than received";
  }
}

}  // namespace kaz::fuzz
