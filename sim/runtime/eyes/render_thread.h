// The one thread that draws.
// SPDX-License-Identifier: Apache-2.0
//
// Started by the first picture, so that a simulation that nobody looks at needs no OpenGL.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"
#include "sim/view/renderer.h"

namespace kaz::sim {

using RendererFactory = std::function<Result<std::unique_ptr<Renderer>>()>;

class RenderThread {
 public:
  // A job gets the renderer, or the reason why there is none. Jobs run in the order of their
  // submission.
  using Job = std::function<void(const Result<Renderer*>&)>;

  RenderThread(Scene scene, RendererFactory factory);
  ~RenderThread();  // jobs that were submitted are done first
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  void submit(Job job);
  // Remembers the first failure of a job; `error()` tells it to the other threads.
  void set_error(Error error);
  std::optional<Error> error() const;

 private:
  void run();

  Scene scene_;
  RendererFactory factory_;
  Result<std::unique_ptr<Renderer>> renderer_ = nullptr;  // of the thread, once that runs
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Job> jobs_;
  bool stop_ = false;
  std::optional<Error> error_;
  std::thread thread_;
};

}  // namespace kaz::sim
