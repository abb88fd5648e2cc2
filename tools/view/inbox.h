// Bounded queue from the publishing threads to the server's thread.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>

#include "tools/view/protocol.h"

namespace kaz::watch {

// Copied once, on publication. Queue, log and all viewers share it.
struct Message {
  static constexpr std::uint32_t kEveryone = 0xffffffff;  // a whole frame for every viewer

  std::uint32_t channel = kEveryone;
  std::uint64_t time_ns = 0;
  bool kept = false;      // later viewers get the channel's newest one
  bool observed = false;  // passed to the server's handler
  bool text = false;      // with kEveryone: a text frame, not a binary one
  Bytes data;

  // Approximate memory in bytes.
  std::size_t size() const { return data.size() + 160; }
};
using SharedMessage = std::shared_ptr<const Message>;

// Thread-safe. Its mutex is only held for a few instructions, never while a viewer is served.
class Inbox {
 public:
  explicit Inbox(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // Returns false if the queue is full. Then the message is dropped, but the newest kept message of each
  // channel still waits beside the queue. An empty queue takes a message of any size.
  bool put(SharedMessage message);
  // Empties the queue and returns its messages, the oldest first.
  std::deque<SharedMessage> take();
  bool empty() const;

 private:
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::deque<SharedMessage> queue_;
  std::size_t bytes_ = 0;                            // in queue_
  std::map<std::uint32_t, SharedMessage> overflow_;  // kept messages newer than those in queue_
};

}  // namespace kaz::watch
