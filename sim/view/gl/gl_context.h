// What the drawing code needs of a window system: an OpenGL 3.3 core context without a window.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "shared/base/result.hpp"

namespace kaz::sim {

class GlContext {
 public:
  using Function = void (*)();

  virtual ~GlContext() = default;
  // Between make_current() and release() the calling thread may use OpenGL.
  virtual Result<void> make_current() = 0;
  virtual void release() = 0;
  // Address of an OpenGL function, or null. The context must be current.
  virtual Function function(const char* name) = 0;
};

}  // namespace kaz::sim
