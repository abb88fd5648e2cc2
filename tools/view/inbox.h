// The bounded queue between the threads that publish and the server's thread.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>

#include "tools/view/protocol.h"

namespace kaz::watch {

// Copied once, when it is published. The queue, the log and all viewers share it.
struct Message {
  static constexpr std::uint32_t kEveryone = 0xffffffff;  // a whole frame for every viewer

  std::uint32_t channel = kEveryone;
  std::uint64_t time_ns = 0;
  bool kept = false;      // viewers that come later get the newest one of the channel
  bool observed = false;  // the server's handler gets it
  bool text = false;      // a frame for everyone: text, not binary
  Bytes data;

  // Memory that it takes, approximately.
  std::size_t size() const { return data.size() + 160; }
};
using SharedMessage = std::shared_ptr<const Message>;

// Thread-safe. Its mutex is held for some instructions, never while a viewer is served.
class Inbox {
 public:
  explicit Inbox(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // Returns false if the queue is full: the message is left out. Of a kept message the newest one of each
  // channel remains: it waits beside the queue.
  bool put(SharedMessage message);
  // Everything that waits, the oldest first; the queue is empty afterwards.
  std::deque<SharedMessage> take();
  bool empty() const;

 private:
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::deque<SharedMessage> queue_;
  std::size_t bytes_ = 0;                            // in queue_
  std::map<std::uint32_t, SharedMessage> overflow_;  // kept ones that are newer than the queue's
};

}  // namespace kaz::watch
