// Renders all pictures of a simulation, one job after the other. The jobs run in a separate thread, or in the
// thread that steps the simulation (enum Drawing).
// SPDX-License-Identifier: Apache-2.0
//
// The first job starts the renderer. A simulation without pictures therefore never starts the renderer.
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
#include "sim/render/renderer.h"

namespace kaz::sim {

using RendererFactory = std::function<Result<std::unique_ptr<Renderer>>()>;

// Thread that renders: a separate thread, or the thread that steps the simulation. Use `caller` in programs
// that simulate many robots, because these programs already use all processors.
enum class Drawing { own_thread, caller };

class RenderThread {
 public:
  // A job receives the renderer, or the error that occurred when the renderer was created. Jobs run in the
  // order of submission.
  using Job = std::function<void(const Result<Renderer*>&)>;

  RenderThread(Scene scene, RendererFactory factory, Drawing drawing = Drawing::own_thread);
  ~RenderThread();  // waits until all submitted jobs are finished
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  // Queues a job. With Drawing::caller, runs the job at once. Call submit() from one thread only.
  void submit(Job job);
  // Stores the first failure of a job; error() returns this failure. Any thread may call set_error() and
  // error().
  void set_error(Error error);
  std::optional<Error> error() const;

 private:
  void run();
  void make_renderer();
  void set_scene();
  Result<Renderer*> for_jobs() const;

  Scene scene_;
  RendererFactory factory_;
  Drawing drawing_;
  bool has_begun_ = false;
  // After `thread_` has started, no other thread uses `renderer_`.
  Result<std::unique_ptr<Renderer>> renderer_ = nullptr;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Job> jobs_;
  bool stop_ = false;
  std::optional<Error> error_;
  std::thread thread_;
};

}  // namespace kaz::sim
