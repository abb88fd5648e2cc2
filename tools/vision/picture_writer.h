// Writes pictures in another thread, because compressing a picture takes longer than processing a frame.
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
#include "tools/base/output.h"
#include "tools/drawing/figure.h"

namespace kaz::tools {

// Runs jobs one after the other in one thread.
class PictureWriter {
 public:
  static constexpr std::size_t kMostWaiting = 64;

  // add() and finish() call `interrupted`, also while they wait. After `interrupted` has returned true, the
  // remaining jobs are dropped. The remaining jobs may take many seconds, but a program must end within one
  // second after an interrupt. If `interrupted` is null, no jobs are dropped.
  explicit PictureWriter(std::function<bool()> interrupted = {})
      : interrupted_(std::move(interrupted)),
        worker_([this](const std::stop_token& stop) { work(stop); }) {}

  // Adds a job that writes a file. If kMostWaiting jobs are in the queue, waits until a job has ended.
  void add(std::function<Result<void>()> write);
  // Adds a job that composes the panels with figure::compose() and writes the picture to the folder under
  // this name.
  void add(const OutputFolder& folder, std::string name, std::vector<figure::Panel> panels,
           int columns);
  // Waits until all jobs have ended or were dropped. Returns the first error of a job.
  Result<void> finish();
  // Returns the number of jobs that were dropped after an interrupt. These are always the last jobs.
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
  std::jthread worker_;  // last member, because the thread uses all members above
};

}  // namespace kaz::tools
