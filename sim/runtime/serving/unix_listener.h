// A listening Unix stream socket at a path.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"

namespace kaz::sim {

// No function blocks. Only the user of this process may connect to the socket.
class UnixListener {
 public:
  // Replaces a stale socket. Returns Fault::environment if another process serves the socket, or if the
  // socket cannot be created. Returns Fault::usage if the path is too long, or if a file at the path is not a
  // socket.
  static Result<std::unique_ptr<UnixListener>> open(const std::string& path);
  ~UnixListener();  // removes the path unless another process has replaced the socket

  // Returns the next client without blocking. The returned descriptor is empty if no client waits or the
  // process has no free descriptor. If the process has no free descriptor, fd() returns -1 for the next 100
  // ms. Without this pause, the waiting client would make each poll() return immediately.
  Descriptor accept();
  // Returns the descriptor for poll(). During a pause after a failed accept(), returns -1, which poll()
  // ignores.
  int fd() const { return paused() ? -1 : socket_.get(); }
  // Returns a timeout for poll(), in ms. During the pause after a failed accept(), the timeout is 100 ms. At
  // all other times, the timeout is -1 (unlimited).
  int max_wait_ms() const;
  const std::string& path() const { return path_; }

 private:
  using Clock = std::chrono::steady_clock;
  UnixListener() = default;
  bool paused() const { return Clock::now() < paused_until_; }

  Descriptor socket_;
  Clock::time_point paused_until_{};
  std::string path_;
  unsigned long long inode_ = 0;
};

}  // namespace kaz::sim
