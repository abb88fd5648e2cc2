// One thread that composes and compresses.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision/picture_writer.h"

#include <chrono>

namespace kaz::tools {
namespace {

// A signal wakes no condition variable.
constexpr std::chrono::milliseconds kQueryInterval{50};

}  // namespace

void PictureWriter::add(const OutputFolder& folder, std::string name,
                        std::vector<figure::Panel> panels, int columns) {
  add([folder, name = std::move(name), panels = std::move(panels), columns]() -> Result<void> {
    return figure::write_png(folder.path(name),
                             figure::compose(panels, columns, panels.front().image.height));
  });
}

void PictureWriter::add(std::function<Result<void>()> write) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (interrupted()) {
      ++dropped_;
      return;
    }
    if (jobs_.size() < kMostWaiting) break;
    changed_.wait_for(lock, kQueryInterval);
  }
  jobs_.push_back(std::move(write));
  changed_.notify_all();
}

Result<void> PictureWriter::finish() {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (interrupted()) {
      dropped_ += jobs_.size();
      jobs_.clear();
    }
    if (jobs_.empty() && !busy_) return written_;
    changed_.wait_for(lock, kQueryInterval);
  }
}

std::size_t PictureWriter::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

void PictureWriter::work(const std::stop_token& stop) {
  for (;;) {
    std::function<Result<void>()> job;
    {
      std::unique_lock lock(mutex_);
      busy_ = false;
      changed_.notify_all();
      if (!changed_.wait(lock, stop, [this] { return !jobs_.empty(); })) return;
      job = std::move(jobs_.front());
      jobs_.pop_front();
      busy_ = true;
    }
    auto done = job();
    const std::lock_guard lock(mutex_);
    if (written_ && !done) written_ = std::move(done);
  }
}

}  // namespace kaz::tools
