// Renderer that works with any OpenGL context.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "sim/view/gl/gl_context.h"
#include "sim/view/renderer.h"

namespace kaz::sim {

using ContextMaker = std::function<Result<std::unique_ptr<GlContext>>()>;

// Sets all environment variables that influence Mesa's pictures to fixed values, for this process.
void fix_mesa_environment();

// Makes a renderer. In the first call of render(), the renderer calls `make_context`.
std::unique_ptr<Renderer> make_gl_renderer(ContextMaker make_context);

}  // namespace kaz::sim
