// A listening Unix stream socket at a path.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"

namespace kaz::sim {

// Non-blocking. Only its user has access.
class UnixListener {
 public:
  // Replaces a stale socket. Returns Fault::environment if another process serves the socket or it cannot be
  // created. Returns Fault::usage for a path that is too long or is not a socket.
  static Result<std::unique_ptr<UnixListener>> open(const std::string& path);
  ~UnixListener();  // removes the path if it is still ours

  // Returns the next client without blocking. The descriptor is empty if no client waits or the process has
  // no free descriptor. In the latter case the socket stays readable, so fd() is -1 for the next 100 ms.
  Descriptor accept();
  // Returns the descriptor for poll(), which ignores -1.
  int fd() const { return paused() ? -1 : socket_.get(); }
  // Returns the longest timeout of poll() that does not miss the end of such a pause, ms; -1 is unlimited.
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
