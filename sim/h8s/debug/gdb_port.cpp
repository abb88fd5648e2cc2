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

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

namespace kaz::h8s {
namespace {

std::string reason() {
  return std::strerror(errno);
}

bool write_all(int fd, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    // A closed connection must be an error, not a signal; send works on sockets only.
    ssize_t n = ::send(fd, text.data() + at, text.size() - at, MSG_NOSIGNAL);
    if (n < 0 && errno == ENOTSOCK) n = ::write(fd, text.data() + at, text.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += static_cast<std::size_t>(n);
  }
  return true;
}

// Until the server has finished, the peer closes or `stop` is readable.
Result<void> converse(GdbServer& server, int in, int out, States slice, int stop) {
  std::array<std::uint8_t, 4096> buffer{};
  while (!server.finished()) {
    pollfd waiting[2] = {{in, POLLIN, 0}, {stop, POLLIN, 0}};
    const int ready = ::poll(waiting, 2, server.running() ? 0 : -1);
    if (ready < 0 && errno != EINTR) return fail("GDB's connection: " + reason());
    if (ready > 0 && waiting[1].revents != 0) return {};
    if (ready > 0) {
      const ssize_t n = ::read(in, buffer.data(), buffer.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return fail("GDB's connection: " + reason());
      if (n == 0) return {};
      server.feed(std::span(buffer.data(), static_cast<std::size_t>(n)));
    }
    if (server.running()) server.run(slice);
    if (!write_all(out, server.take_output())) return {};
  }
  return {};
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
      return fail("the path of the GDB socket is too long: " + where);
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
    return fail("'" + where + "' is neither a port (0 to 65535) nor a path with a '/' nor '-'");
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

Result<void> GdbPort::serve(GdbServer& server, States slice, int stop) {
  if (standard_) return converse(server, STDIN_FILENO, STDOUT_FILENO, slice, stop);
  int connection = -1;
  do {
    pollfd waiting[2] = {{listener_, POLLIN, 0}, {stop, POLLIN, 0}};
    if (::poll(waiting, 2, -1) < 0 && errno == EINTR) continue;
    if (waiting[1].revents != 0) return {};
    connection = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  } while (connection < 0 && errno == EINTR);
  if (connection < 0) return fail("waiting for GDB: " + reason());
  const int on = 1;
  ::setsockopt(connection, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  auto result = converse(server, connection, connection, slice, stop);
  ::close(connection);
  return result;
}

}  // namespace kaz::h8s
