// Transport of GDB's remote protocol: local TCP, a Unix socket, or standard input and output.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/gdb_port.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

#include "shared/base/browser_guard.hpp"
#include "shared/base/descriptor.hpp"

namespace kaz::h8s {
namespace {

constexpr int kAcceptPause_ms = 100;

std::string reason() {
  return std::strerror(errno);
}

// Writes what `fd` takes without waiting, at least one byte where poll() has reported room. False: closed.
bool write_some(int fd, std::string& text) {
  // A closed connection must be an error, not a signal; send works on sockets only.
  ssize_t n = ::send(fd, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  // A pipe with room takes PIPE_BUF bytes. It stays blocking: others may have the same end of it.
  if (n < 0 && errno == ENOTSOCK)
    n = ::write(fd, text.data(), std::min(text.size(), std::size_t{PIPE_BUF}));
  if (n < 0) return errno == EINTR || errno == EAGAIN;
  text.erase(0, static_cast<std::size_t>(n));
  return true;
}

enum class Ended { gdb, silent, browser, stopped };

// Until the server has finished, the peer closes or `stop` is readable. A peer that has sent nothing gives
// way to one that waits at `listener` (-1: none). A peer that does not read is not read from either, so that
// its replies take no more memory than one buffer of requests makes.
Result<Ended> converse(GdbServer& server, int in, int out, States slice, int stop, int listener) {
  std::array<std::uint8_t, 4096> buffer{};
  BrowserGuard guard(BrowserGuard::Peer::gdb);
  std::string unsent;
  const auto ended = [&guard] { return guard.admitted() ? Ended::gdb : Ended::silent; };
  while (!server.finished() || !unsent.empty()) {
    pollfd waiting[] = {{unsent.empty() ? in : -1, POLLIN, 0},
                        {unsent.empty() ? -1 : out, POLLOUT, 0},
                        {stop, POLLIN, 0},
                        {guard.admitted() ? -1 : listener, POLLIN, 0}};
    const auto& [readable, writable, stopped, newcomer] = waiting;
    const int ready = ::poll(waiting, std::size(waiting), server.running() ? 0 : -1);
    if (ready < 0 && errno != EINTR) return fail("GDB's connection: " + reason());
    if (ready > 0 && stopped.revents != 0) return Ended::stopped;
    if (ready > 0 && writable.revents != 0 && !write_some(out, unsent)) return ended();
    if (ready > 0 && readable.revents != 0) {
      const ssize_t n = ::read(in, buffer.data(), buffer.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && errno != ECONNRESET) return fail("GDB's connection: " + reason());
      if (n <= 0) return ended();
      const std::span<const std::uint8_t> all(buffer.data(), static_cast<std::size_t>(n));
      // No browser reaches standard input.
      const auto bytes = listener < 0 ? std::optional(all) : guard.admit(all);
      if (!bytes) return Ended::browser;
      server.feed(*bytes);
    } else if (ready > 0 && newcomer.revents != 0) {
      return Ended::silent;
    }
    if (server.running()) server.run(slice);
    unsent += server.take_output();
  }
  return Ended::gdb;
}

// The next client; empty: `stop` is readable.
Descriptor accept_client(int listener, int stop) {
  while (true) {
    pollfd waiting[] = {{listener, POLLIN, 0}, {stop, POLLIN, 0}};
    auto& stopped = waiting[1];
    if (::poll(waiting, std::size(waiting), -1) < 0 && errno == EINTR) continue;
    if (stopped.revents != 0) return Descriptor();
    Descriptor connection(::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC));
    if (connection) return connection;
    // Out of descriptors, for example: the listener stays readable although nothing can be done about it.
    ::poll(&stopped, 1, kAcceptPause_ms);
  }
}

}  // namespace

Result<GdbPort> GdbPort::open(const std::string& where) {
  GdbPort p;
  if (where == "-") {
    p.standard_ = true;
    return p;
  }
  if (where.find('/') != std::string::npos) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (where.size() >= sizeof address.sun_path)
      return fail("GDB socket path " + where + ": must be at most " +
                  std::to_string(sizeof address.sun_path - 1) + " bytes");
    std::memcpy(address.sun_path, where.data(), where.size());
    p.listener_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (p.listener_ < 0 ||
        ::bind(p.listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        ::listen(p.listener_, 1) != 0)
      return fail("cannot make the GDB socket " + where + ": " + reason());
    p.path_ = where;
    struct stat status {};
    if (::lstat(where.c_str(), &status) == 0) p.inode_ = status.st_ino;
    return p;
  }
  int number = -1;
  const auto [end, error] = std::from_chars(where.data(), where.data() + where.size(), number);
  if (error != std::errc() || end != where.data() + where.size() || number < 0 || number > 65535)
    return fail("GDB address '" + where +
                "': must be a port (0 to 65535), a path with a '/', or '-'");
  p.listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(number));
  const int on = 1;
  ::setsockopt(p.listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  socklen_t size = sizeof address;
  if (p.listener_ < 0 ||
      ::bind(p.listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(p.listener_, 1) != 0 ||
      ::getsockname(p.listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return fail("cannot listen for GDB on port " + where + ": " + reason());
  p.port_ = ntohs(address.sin_port);
  return p;
}

GdbPort::GdbPort(GdbPort&& other) noexcept
    : listener_(std::exchange(other.listener_, -1)),
      port_(other.port_),
      path_(std::exchange(other.path_, {})),
      inode_(other.inode_),
      standard_(other.standard_) {}

GdbPort::~GdbPort() {
  if (listener_ >= 0) ::close(listener_);
  // Another process may have replaced it.
  struct stat status {};
  if (!path_.empty() && ::lstat(path_.c_str(), &status) == 0 && status.st_ino == inode_)
    ::unlink(path_.c_str());
}

std::string GdbPort::hint() const {
  if (standard_) return "target remote | ...";
  return "target remote " + (path_.empty() ? "localhost:" + std::to_string(port_) : path_);
}

Result<void> GdbPort::serve(GdbServer& server, States slice, int stop, const Report& report) {
  if (standard_) {
    KAZ_TRY(converse(server, STDIN_FILENO, STDOUT_FILENO, slice, stop, -1));
    return {};
  }
  while (true) {
    const Descriptor connection = accept_client(listener_, stop);
    if (!connection) return {};
    const int on = 1;
    ::setsockopt(connection.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    const int peer = connection.get();
    const Ended ended = KAZ_TRY(converse(server, peer, peer, slice, stop, listener_));
    if (ended == Ended::gdb || ended == Ended::stopped) return {};
    if (ended == Ended::browser && report) report(std::string("a client ").append(kBrowserRefused));
  }
}

}  // namespace kaz::h8s
