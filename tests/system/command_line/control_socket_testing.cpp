// One request over a Unix socket.
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/command_line/control_socket_testing.h"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <stdexcept>

namespace kaz::test {

std::string query_control(const std::string& path, const std::string& request) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) throw std::runtime_error(path + " is too long");
  path.copy(address.sun_path, path.size());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval patience{10, 0};
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  const std::string line = request + "\n";
  std::string reply;
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      send(fd, line.data(), line.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(line.size())) {
    char piece[512];
    ssize_t count = 0;
    while (reply.find('\n') == std::string::npos && (count = recv(fd, piece, sizeof piece, 0)) > 0)
      reply.append(piece, static_cast<std::size_t>(count));
  }
  close(fd);
  if (reply.find('\n') == std::string::npos)
    throw std::runtime_error("no answer from " + path + " to `" + request + "`");
  return reply.substr(0, reply.find('\n'));
}

}  // namespace kaz::test
