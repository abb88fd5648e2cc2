// The deterministic executor: results by simulated time alone.
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

class LockstepExecutor final : public Executor {
 public:
  LockstepExecutor() : worker_([this](std::stop_token stop) { work(stop); }) {}

  void submit(Work work) override {
    auto item = std::make_shared<Item>();
    item->work = std::move(work);
    pending_.push_back(item);
    ++statistics_.submitted;
    {
      const std::lock_guard lock(mutex_);
      queue_.push_back(std::move(item));
    }
    changed_.notify_all();
  }

  std::size_t poll(Time now) override {
    std::vector<std::shared_ptr<Item>> ready;
    std::copy_if(pending_.begin(), pending_.end(), std::back_inserter(ready),
                 [now](const auto& item) { return item->work.due <= now; });
    std::erase_if(pending_, [now](const auto& item) { return item->work.due <= now; });
    std::stable_sort(ready.begin(), ready.end(),
                     [](const auto& a, const auto& b) { return a->work.due < b->work.due; });
    for (const auto& item : ready) {
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return item->done; });
      }
      ++statistics_.delivered;
      item->work.deliver();
    }
    return ready.size();
  }

  ExecutorStatistics statistics() const override { return statistics_; }

 private:
  struct Item {
    Work work;
    bool done = false;  // under the mutex
  };

  void work(const std::stop_token& stop) {
    for (;;) {
      std::shared_ptr<Item> item;
      {
        std::unique_lock lock(mutex_);
        if (!changed_.wait(lock, stop, [this] { return !queue_.empty(); })) return;
        if (stop.stop_requested()) return;
        item = std::move(queue_.front());
        queue_.pop_front();
      }
      item->work.run(stop);
      {
        const std::lock_guard lock(mutex_);
        item->done = true;
      }
      changed_.notify_all();
    }
  }

  std::vector<std::shared_ptr<Item>> pending_;  // caller's thread only
  ExecutorStatistics statistics_;               // caller's thread only
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::shared_ptr<Item>> queue_;
  std::jthread worker_;  // last: stops and joins before the rest goes
};

}  // namespace

std::unique_ptr<Executor> make_lockstep_executor() {
  return std::make_unique<LockstepExecutor>();
}

}  // namespace kaz::vision
