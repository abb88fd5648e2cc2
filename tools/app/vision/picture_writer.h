// Writes pictures beside the work that makes them: compressing one takes longer than looking at it.
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

class PictureWriter {
 public:
  static constexpr std::size_t kMostWaiting = 64;

  // `interrupted`: asked by add() and finish(), also while they wait. Once true, what is not written yet is
  // dropped: many seconds of work may wait, and an interrupt ends a program within one. Null: never.
  explicit PictureWriter(std::function<bool()> interrupted = {})
      : interrupted_(std::move(interrupted)),
        worker_([this](const std::stop_token& stop) { work(stop); }) {}

  // Something that makes and writes a file. Waits while kMostWaiting are not written yet.
  void add(std::function<Result<void>()> write);
  // Panels as figure::compose() takes them, as a result of that name.
  void add(const OutputFolder& folder, std::string name, std::vector<figure::Panel> panels,
           int columns);
  // Until all are written or dropped; the first error, if there was one.
  Result<void> finish();
  // Files that an interrupt kept from being written: the last ones.
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
  std::jthread worker_;  // last: it uses all of the above
};

}  // namespace kaz::tools
