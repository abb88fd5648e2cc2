// Renderers of one scene for many robots: one renderer per drawing thread.
// SPDX-License-Identifier: Apache-2.0
//
// A renderer contains meshes and textures. All robots of one world have equal meshes and textures, so they
// share the renderers. Thread-safe.
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

  // Returns the renderer of the calling thread. The Renderers object owns the renderer.
  Result<sim::Renderer*> mine();
  // Returns a factory. Renderers from this factory draw with mine() and ignore the scene passed to the
  // factory. The Renderers object must outlive these renderers.
  sim::RendererFactory shared();

 private:
  sim::Scene scene_;
  sim::RendererFactory factory_;
  std::mutex mutex_;
  std::map<std::thread::id, std::unique_ptr<sim::Renderer>> made_;
};

}  // namespace kaz::python
