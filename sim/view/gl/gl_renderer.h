// Renderer on any OpenGL context.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "sim/view/gl/gl_context.h"
#include "sim/view/renderer.h"

namespace kaz::sim {

using ContextMaker = std::function<Result<std::unique_ptr<GlContext>>()>;

// Sets the environment variables that influence Mesa's drawing, for this process.
void fix_mesa_environment();

// The context is made in the first call to render().
std::unique_ptr<Renderer> make_gl_renderer(ContextMaker make_context);

}  // namespace kaz::sim
