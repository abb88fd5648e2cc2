// The simulator's control socket, seen from the host.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/control_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "shared/base/one_line.hpp"

namespace kaz::host {
namespace {

using Steady = std::chrono::steady_clock;

constexpr std::size_t kLongestReply = 65536;
constexpr std::chrono::seconds kPatience{5};
constexpr std::size_t kMaxShown = 1000;  // bytes of a refusal in an error message

// Waits for the reply to `line`, up to its end. Empty: it is in `reply`; else why it is not.
std::string receive(int fd, const std::string& line, const Interrupt* interrupt,
                    std::string& reply) {
  const auto deadline = Steady::now() + kPatience;
  while (reply.find('\n') == std::string::npos) {
    if (interrupt && interrupt->ends_waiting()) return "interrupted";
    const Time left = std::max(Time(deadline - Steady::now()), Time::zero());
    const Time wait = interrupt ? interrupt->max_wait(left) : left;
    pollfd watched[2] = {{fd, POLLIN, 0}, {interrupt ? interrupt->descriptor() : -1, POLLIN, 0}};
    // A millisecond more than nothing, lest the rest be waited for in a busy loop.
    const auto wait_ms = static_cast<int>(wait.count() / 1'000'000 + (wait > Time::zero() ? 1 : 0));
    // Stopped and continued, this program looks once more before it gives up.
    if (poll(watched, 2, wait_ms) <= 0) {
      if (left == Time::zero()) return "no reply to `" + line + "`";
      continue;
    }
    if (watched[0].revents == 0) continue;
    char piece[512];
    const ssize_t count = recv(fd, piece, sizeof piece, MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (count <= 0) return "no reply to `" + line + "`";
    reply.append(piece, static_cast<std::size_t>(count));
    if (reply.size() > kLongestReply || Steady::now() > deadline)
      return "the reply to `" + line + "` took more than 5 s, or had more than 65536 bytes";
  }
  return "";
}

}  // namespace

Result<std::string> query_control_socket(const std::string& path, const std::string& line,
                                         const Interrupt* interrupt) {
  const auto failure = [&](const std::string& why) {
    return fail(Fault::environment, "control socket " + path + ": " + why +
                                        "; check that `kaz sim --serial …` is running and that "
                                        "this is its .ctl");
  };
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return failure("the path is too long");
  std::memcpy(address.sun_path, path.c_str(), path.size());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return failure(std::strerror(errno));
  // Where a program that does not run has left requests unread, connecting waits too.
  const timeval patience{kPatience.count(), 0};
  setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  std::string reply;
  std::string why;
  const std::string request = line + "\n";
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      send(fd, request.data(), request.size(), MSG_NOSIGNAL) !=
          static_cast<ssize_t>(request.size())) {
    why = std::strerror(errno);
  }
  if (why.empty()) why = receive(fd, line, interrupt, reply);
  close(fd);
  if (interrupt && interrupt->ends_waiting()) return tl::unexpected(Interrupt::error());
  if (!why.empty()) return failure(why);
  reply.resize(reply.find('\n'));
  if (reply.find("\"ok\":true") == std::string::npos)
    return fail(Fault::environment, "control socket " + path + " refused `" + line +
                                        "`: " + cut_text(one_line(reply), kMaxShown));
  return reply;
}

}  // namespace kaz::host
