// The real-time executor: newest frame wins.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "vision/pipeline.h"

namespace kaz::vision {

namespace {

class RealtimeExecutor final : public Executor {
 public:
  RealtimeExecutor() : worker_([this](std::stop_token stop) { work(stop); }) {}

  void submit(Work work) override {
    {
      const std::lock_guard lock(mutex_);
      ++statistics_.submitted;
      const auto older = std::find_if(waiting_.begin(), waiting_.end(),
                                      [&](const Work& w) { return w.module == work.module; });
      if (older != waiting_.end()) {
        *older = std::move(work);  // keeps its place: no module starves another
        ++statistics_.dropped;
      } else {
        waiting_.push_back(std::move(work));
      }
    }
    changed_.notify_all();
  }

  std::size_t poll(Time) override {
    std::vector<Work> ready;
    {
      const std::lock_guard lock(mutex_);
      ready.swap(done_);
      statistics_.delivered += ready.size();
    }
    for (const Work& work : ready) work.deliver();
    return ready.size();
  }

  ExecutorStatistics statistics() const override {
    const std::lock_guard lock(mutex_);
    return statistics_;
  }

 private:
  void work(const std::stop_token& stop) {
    for (;;) {
      Work work;
      {
        std::unique_lock lock(mutex_);
        if (!changed_.wait(lock, stop, [this] { return !waiting_.empty(); })) return;
        if (stop.stop_requested()) return;
        work = std::move(waiting_.front());
        waiting_.pop_front();
      }
      work.run(stop);
      const std::lock_guard lock(mutex_);
      done_.push_back(std::move(work));
    }
  }

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Work> waiting_;
  std::vector<Work> done_;
  ExecutorStatistics statistics_;
  std::jthread worker_;  // last: stops and joins before the rest goes
};

}  // namespace

std::unique_ptr<Executor> make_realtime_executor() {
  return std::make_unique<RealtimeExecutor>();
}

}  // namespace kaz::vision
