// Binds a socket to a path; detects stale sockets.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/unix_listener.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>

namespace kaz::sim {
namespace {

constexpr std::chrono::milliseconds kPause(100);

Descriptor stream_socket() {
  return Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

// A socket is stale only if the connection is refused. A full backlog (EAGAIN), another type of socket
// (EPROTOTYPE, e.g. /dev/log) and missing permission (EACCES) mean that it is in use.
bool is_served(const sockaddr_un& address) {
  const Descriptor probe = stream_socket();
  const auto* to = reinterpret_cast<const sockaddr*>(&address);
  return ::connect(probe.get(), to, sizeof address) == 0 || errno != ECONNREFUSED;
}

}  // namespace

Result<std::unique_ptr<UnixListener>> UnixListener::open(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path)
    return fail(Fault::usage, "the socket path `" + path + "` must have 1 to " +
                                  std::to_string(sizeof address.sun_path - 1) + " characters");
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);

  struct stat status {};
  if (::lstat(path.c_str(), &status) == 0) {
    if (!S_ISSOCK(status.st_mode))
      return fail(Fault::usage,
                  path + " exists and is not a socket; choose another path, or remove the file");
    if (is_served(address))
      return fail(
          Fault::environment,
          path + " is served by another process; stop that process, or choose another path");
    ::unlink(path.c_str());
  }

  std::unique_ptr<UnixListener> listener(new UnixListener);
  listener->socket_ = stream_socket();
  const int fd = listener->socket_.get();
  // bind() creates the path with the mode of the descriptor.
  ::fchmod(fd, S_IRUSR | S_IWUSR);
  if (fd < 0 || ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(fd, 8) != 0 || ::lstat(path.c_str(), &status) != 0)
    return fail(Fault::environment,
                "cannot listen at " + path + ": " + std::strerror(errno) + "; choose another path");
  listener->path_ = path;
  listener->inode_ = status.st_ino;
  return listener;
}

UnixListener::~UnixListener() {
  struct stat status {};
  if (!path_.empty() && ::lstat(path_.c_str(), &status) == 0 && status.st_ino == inode_)
    ::unlink(path_.c_str());
}

Descriptor UnixListener::accept() {
  Descriptor client(::accept4(socket_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!client && errno != EAGAIN) paused_until_ = Clock::now() + kPause;
  return client;
}

int UnixListener::max_wait_ms() const {
  return paused() ? static_cast<int>(kPause.count()) : -1;
}

}  // namespace kaz::sim
