// A listening Unix stream socket at a path.
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

  // The next client, non-blocking; an empty descriptor if none is waiting.
  Descriptor accept();
  int fd() const { return socket_.get(); }
  const std::string& path() const { return path_; }

 private:
  UnixListener() = default;

  Descriptor socket_;
  std::string path_;
  unsigned long long inode_ = 0;
};

}  // namespace kaz::sim
