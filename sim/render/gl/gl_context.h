// Contexts of OpenGL 3.3 (core profile) without a window.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "shared/base/result.hpp"

namespace kaz::sim {

class GlContext {
 public:
  using Function = void (*)();

  virtual ~GlContext() = default;
  // Between make_current() and release(), the calling thread may call OpenGL functions.
  virtual Result<void> make_current() = 0;
  virtual void release() = 0;
  // Returns the address of an OpenGL function, or null. The context must be current.
  virtual Function function(const char* name) = 0;
};

// Makes a context with off-screen Mesa. Returns Fault::environment if off-screen Mesa is not available.
Result<std::unique_ptr<GlContext>> make_osmesa_context();
// Makes an EGL 1.5 context without a surface (EGL_MESA_platform_surfaceless). Loads libEGL at run time;
// returns Fault::environment if libEGL is absent.
Result<std::unique_ptr<GlContext>> make_egl_context();

}  // namespace kaz::sim
