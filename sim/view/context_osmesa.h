// An OpenGL context on off-screen Mesa.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/view/gl_context.h"

namespace kaz::sim {

// Fixes, for this process, what of Mesa's drawing the environment could change.
void fix_mesa_environment();

Result<std::unique_ptr<GlContext>> make_osmesa_context();

}  // namespace kaz::sim
