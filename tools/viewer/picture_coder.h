// A thread of low priority that encodes pictures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace kaz::viewer {

class PictureCoder {
 public:
  PictureCoder() : thread_([this] { work(); }) {}
  ~PictureCoder() { finish(); }
  PictureCoder(const PictureCoder&) = delete;
  PictureCoder& operator=(const PictureCoder&) = delete;

  // Queues a task. If more than four tasks wait, drops the oldest one. Any thread may call this function.
  void add(std::function<void()> task);
  // Waits until the queued tasks are done, and ends the thread. Later tasks are not executed.
  void finish();

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  bool ended_ = false;
  std::thread thread_;  // begins when the other members exist
};

}  // namespace kaz::viewer
