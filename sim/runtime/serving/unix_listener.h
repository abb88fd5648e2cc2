// A Unix stream socket at a path, listening.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "shared/base/result.hpp"
#include "sim/runtime/serving/descriptor.h"

namespace kaz::sim {

// Never waits. Readable and writable by its user alone.
class UnixListener {
 public:
  // A socket that another process left behind is replaced; one that is served, and anything else,
  // is not.
  static Result<std::unique_ptr<UnixListener>> open(const std::string& path);
  ~UnixListener();  // removes the path, if it is still ours

  // The next client; an empty descriptor if none waits. Never blocks afterwards.
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
