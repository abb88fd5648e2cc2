// Flag that is set by an interrupt, for code that polls a flag instead of a descriptor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>

#include <atomic>
#include <thread>

#include "host/link/interrupt.h"

namespace kaz::tools {

// A thread of this object waits for the interrupt. The destructor requests the interrupt, so that this thread
// ends. `interrupt` must outlive the object.
class StopFlag {
 public:
  explicit StopFlag(host::Interrupt& interrupt)
      : interrupt_(interrupt), thread_([this] {
          pollfd watched{interrupt_.descriptor(), POLLIN, 0};
          while (poll(&watched, 1, -1) < 0) continue;
          stop_ = true;
        }) {}
  ~StopFlag() {
    interrupt_.request();
    thread_.join();
  }
  const std::atomic<bool>& flag() const { return stop_; }

 private:
  host::Interrupt& interrupt_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace kaz::tools
