// The thread that renders all pictures.
// SPDX-License-Identifier: Apache-2.0
//
// Started by the first picture, so a simulation without pictures starts no renderer.
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
  // A job gets the renderer, or the error that prevented it. Jobs run in the order of submission.
  using Job = std::function<void(const Result<Renderer*>&)>;

  RenderThread(Scene scene, RendererFactory factory);
  ~RenderThread();  // finishes submitted jobs first
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  void submit(Job job);
  // Stores the first failure of a job; error() returns it, from any thread.
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
