// Runs the thread that encodes pictures.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/picture_coder.h"

#include <sys/resource.h>

#include <future>
#include <utility>

#include "tools/viewer/server.h"

namespace kaz::viewer {

void PictureCoder::add(std::function<void()> task) {
  constexpr std::size_t kMost = 4;
  const std::lock_guard lock(mutex_);
  tasks_.push_back(std::move(task));
  if (tasks_.size() > kMost) tasks_.pop_front();
  changed_.notify_all();
}

void PictureCoder::finish() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void PictureCoder::work() {
  setpriority(PRIO_PROCESS, 0, kViewNice);  // Linux: of this thread alone
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ended_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    const std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    try {
      task();
    } catch (const std::future_error&) {
      // The run ended before the pair was drawn.
    }
    lock.lock();
  }
}

}  // namespace kaz::viewer
