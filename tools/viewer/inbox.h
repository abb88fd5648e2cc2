// Bounded queue of messages from the publishing threads to the server's thread.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>

#include "tools/viewer/protocol.h"

namespace kaz::viewer {

// A published message. `data` is copied only once, at publication. The queue, the log and all viewers share
// the copy.
struct Message {
  // Value of `channel` for a message that is a complete frame for every viewer.
  static constexpr std::uint32_t kEveryone = 0xffffffff;

  std::uint32_t channel = kEveryone;
  std::uint64_t time_ns = 0;
  bool kept = false;      // true: later subscribers also get the newest message of the channel
  bool observed = false;  // true: the message is passed to the server's handler
  bool text = false;      // with kEveryone: true for a text frame, false for a binary frame
  Bytes data;

  // Returns the approximate memory of the message in bytes.
  std::size_t size() const { return data.size() + 160; }
};
using SharedMessage = std::shared_ptr<const Message>;

// Thread-safe. The mutex is held only for a few instructions, never during work for a viewer.
class Inbox {
 public:
  explicit Inbox(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // Adds a message. Returns false if the queue is full. The message is then dropped. However, the newest
  // message with `kept` of each channel is not dropped, but waits in a separate map. An empty queue accepts a
  // message of any length.
  bool put(SharedMessage message);
  // Empties the queue and returns its messages, oldest first.
  std::deque<SharedMessage> take();
  bool empty() const;

 private:
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::deque<SharedMessage> queue_;
  std::size_t bytes_ = 0;  // total length of the messages in queue_
  // Messages with `kept` that are newer than all messages in queue_.
  std::map<std::uint32_t, SharedMessage> overflow_;
};

}  // namespace kaz::viewer
