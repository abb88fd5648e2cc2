// An OpenGL context on EGL without a surface.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/view/gl/gl_context.h"

namespace kaz::sim {

// Needs EGL 1.5 with EGL_MESA_platform_surfaceless, looked up when it is called: the program runs
// without libEGL too.
Result<std::unique_ptr<GlContext>> make_egl_context();

}  // namespace kaz::sim
