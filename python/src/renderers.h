// Renderers of one scene for many robots: one for each thread that draws.
// SPDX-License-Identifier: Apache-2.0
//
// A renderer holds meshes and textures; robots of one world have the same ones.
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

  // That of the calling thread.
  Result<sim::Renderer*> mine();
  // Makes renderers that draw by mine(), and ignore what scene they are given. This object must outlive them.
  sim::RendererFactory shared();

 private:
  sim::Scene scene_;
  sim::RendererFactory factory_;
  std::mutex mutex_;
  std::map<std::thread::id, std::unique_ptr<sim::Renderer>> made_;
};

}  // namespace kaz::python
