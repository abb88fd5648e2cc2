// The simulator's control socket, seen from the host.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/control_socket.h"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

namespace kaz::host {
namespace {

constexpr std::size_t kLongestReply = 65536;

}  // namespace

Result<std::string> query_control_socket(const std::string& path, const std::string& line) {
  const auto failure = [&](const std::string& why) {
    return fail(Fault::environment, "control socket " + path + ": " + why +
                                        "; is `kaz sim --serial …` running, and is this its .ctl?");
  };
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return failure("the path is too long");
  std::memcpy(address.sun_path, path.c_str(), path.size());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return failure(std::strerror(errno));
  const timeval patience{5, 0};
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  std::string reply;
  std::string why;
  const std::string request = line + "\n";
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      send(fd, request.data(), request.size(), MSG_NOSIGNAL) !=
          static_cast<ssize_t>(request.size())) {
    why = std::strerror(errno);
  }
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(patience.tv_sec);
  while (why.empty() && reply.find('\n') == std::string::npos) {
    char piece[512];
    const ssize_t count = recv(fd, piece, sizeof piece, 0);
    if (reply.size() > kLongestReply || std::chrono::steady_clock::now() > deadline) {
      why = "no end of the reply to `" + line + "`";
    } else if (count <= 0) {
      why = "no reply to `" + line + "`";
    } else {
      reply.append(piece, static_cast<std::size_t>(count));
    }
  }
  close(fd);
  if (!why.empty()) return failure(why);
  reply.resize(reply.find('\n'));
  if (reply.find("\"ok\":true") == std::string::npos)
    return fail(Fault::environment, "control socket " + path + " refused `" + line + "`: " + reply);
  return reply;
}

}  // namespace kaz::host
