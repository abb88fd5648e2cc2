// Writes pictures in another thread: compressing one takes longer than processing it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/base/output.h"
#include "tools/figure/figure.h"

namespace kaz::tools {

// Runs jobs in order in one thread.
class PictureWriter {
 public:
  static constexpr std::size_t kMostWaiting = 64;

  // add() and finish() call `interrupted`, also while they wait. Once it returns true, unwritten jobs are
  // dropped: they may need many seconds, and a program must end within one after an interrupt. Null: never
  // interrupted.
  explicit PictureWriter(std::function<bool()> interrupted = {})
      : interrupted_(std::move(interrupted)),
        worker_([this](const std::stop_token& stop) { work(stop); }) {}

  // Adds a job that writes a file. Waits while kMostWaiting jobs are in the queue.
  void add(std::function<Result<void>()> write);
  // Adds panels for figure::compose(), as a result with this name.
  void add(const OutputFolder& folder, std::string name, std::vector<figure::Panel> panels,
           int columns);
  // Waits until all jobs are written or dropped. Returns the first error.
  Result<void> finish();
  // Number of files that were dropped after an interrupt: the last ones.
  std::size_t dropped() const;

 private:
  void work(const std::stop_token& stop);
  bool interrupted() const { return interrupted_ && interrupted_(); }

  std::function<bool()> interrupted_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::function<Result<void>()>> jobs_;
  bool busy_ = false;
  std::size_t dropped_ = 0;
  Result<void> written_;
  std::jthread worker_;  // last, because it uses all members above
};

}  // namespace kaz::tools
