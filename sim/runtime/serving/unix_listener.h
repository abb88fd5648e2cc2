// A listening Unix stream socket at a path.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"

namespace kaz::sim {

// Non-blocking. Accessible by its user only.
class UnixListener {
 public:
  // Replaces a stale socket. Errors: a socket in use or anything else exists at the path.
  static Result<std::unique_ptr<UnixListener>> open(const std::string& path);
  ~UnixListener();  // removes the path, if it is still ours

  // The next client, non-blocking; an empty descriptor if none is waiting, or if the process has no
  // descriptor left. In the latter case the socket stays readable, so fd() is -1 for the next 100 ms.
  Descriptor accept();
  // For poll(), which ignores -1.
  int fd() const { return paused() ? -1 : socket_.get(); }
  // The longest poll() may wait so as not to miss the end of such a pause, ms; -1: any time.
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
