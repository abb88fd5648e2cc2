// Renderers of one scene for many robots, one per drawing thread.
// SPDX-License-Identifier: Apache-2.0
//
// A renderer contains meshes and textures, which are the same for all robots of one world. Thread-safe.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "shared/base/result.hpp"
#include "sim/runtime/eyes/render_thread.h"

namespace kaz::python {

class Renderers {
 public:
  Renderers(sim::Scene scene, sim::RendererFactory factory)
      : scene_(std::move(scene)), factory_(std::move(factory)) {}

  // Returns the renderer of the calling thread; this object owns it.
  Result<sim::Renderer*> mine();
  // Returns a factory of renderers that draw by mine() and ignore the scene that they are given. This object
  // must outlive them.
  sim::RendererFactory shared();

 private:
  sim::Scene scene_;
  sim::RendererFactory factory_;
  std::mutex mutex_;
  std::map<std::thread::id, std::unique_ptr<sim::Renderer>> made_;
};

}  // namespace kaz::python
