// A queue of drawing jobs and the thread that does them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/eyes/render_thread.h"

#include <utility>

namespace kaz::sim {

RenderThread::RenderThread(Scene scene, RendererFactory factory, Drawing drawing)
    : scene_(std::move(scene)), factory_(std::move(factory)), drawing_(drawing) {}

RenderThread::~RenderThread() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void RenderThread::make_renderer() {
  renderer_ = factory_();
  if (!renderer_) set_error(renderer_.error());
}

void RenderThread::set_scene() {
  if (!renderer_) return;
  if (auto set = (*renderer_)->set_scene(scene_); !set) {
    renderer_ = tl::unexpected(set.error());
    set_error(set.error());
  }
}

Result<Renderer*> RenderThread::for_jobs() const {
  return renderer_ ? Result<Renderer*>(renderer_->get()) : tl::unexpected(renderer_.error());
}

void RenderThread::submit(Job job) {
  const bool first = !std::exchange(has_begun_, true);
  if (drawing_ == Drawing::caller) {
    if (first) {
      make_renderer();
      set_scene();
    }
    return job(for_jobs());
  }
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  wake_.notify_one();
  if (!first) return;
  // Created in the caller's thread because it may set environment variables; everything else runs in ours.
  make_renderer();
  thread_ = std::thread([this] { run(); });
}

void RenderThread::run() {
  set_scene();
  const Result<Renderer*> renderer = for_jobs();
  while (true) {
    Job job;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
      if (jobs_.empty()) break;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    job(renderer);
  }
  renderer_ = nullptr;  // an OpenGL context is destroyed in the thread that used it
}

void RenderThread::set_error(Error error) {
  const std::lock_guard lock(mutex_);
  if (!error_) error_ = std::move(error);
}

std::optional<Error> RenderThread::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

}  // namespace kaz::sim
