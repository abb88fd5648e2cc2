// The bounded queue between the threads that publish and the server's thread.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/inbox.h"

#include <utility>

namespace kaz::viewer {

bool Inbox::put(SharedMessage message) {
  const std::size_t size = message->size();
  const std::lock_guard lock(mutex_);
  // An empty queue takes a message of any size.
  const bool fits = queue_.empty() || bytes_ + size <= most_bytes_;
  if (fits) {
    if (message->kept) overflow_.erase(message->channel);
    bytes_ += size;
    queue_.push_back(std::move(message));
  } else if (message->kept) {
    overflow_[message->channel] = std::move(message);
  }
  return fits;
}

std::deque<SharedMessage> Inbox::take() {
  const std::lock_guard lock(mutex_);
  std::deque<SharedMessage> all = std::exchange(queue_, {});
  for (auto& [channel, message] : overflow_) all.push_back(std::move(message));
  overflow_.clear();
  bytes_ = 0;
  return all;
}

bool Inbox::empty() const {
  const std::lock_guard lock(mutex_);
  return queue_.empty() && overflow_.empty();
}

}  // namespace kaz::viewer
