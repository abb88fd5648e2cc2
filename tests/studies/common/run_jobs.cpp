// Runs independent jobs on several threads.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/common/run_jobs.h"

#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

namespace kaz::studies {

Result<void> run_jobs(std::size_t count, int threads,
                      const std::function<std::function<Result<void>()>(std::size_t)>& work) {
  std::mutex mutex;
  std::atomic<std::size_t> next = 0;
  Result<void> result;
  {
    std::vector<std::jthread> workers;
    for (int t = 0; t < threads; ++t) {
      workers.emplace_back([&] {
        for (std::size_t i = next++; i < count; i = next++) {
          const auto store = work(i);
          const std::lock_guard lock(mutex);
          if (!result) return;
          result = store();
          if (!result) next = count;
        }
      });
    }
  }
  return result;
}

}  // namespace kaz::studies
