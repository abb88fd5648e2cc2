// Renderer that works with any OpenGL context.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "sim/render/gl/gl_context.h"
#include "sim/render/renderer.h"

namespace kaz::sim {

using ContextMaker = std::function<Result<std::unique_ptr<GlContext>>()>;

// In this process, assigns fixed values to the environment variables on which Mesa's pictures depend.
void fix_mesa_environment();

// Makes a renderer. In the first call of render(), the renderer calls `make_context`.
std::unique_ptr<Renderer> make_gl_renderer(ContextMaker make_context);

}  // namespace kaz::sim
