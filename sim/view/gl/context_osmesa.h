// An OpenGL context on off-screen Mesa.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/view/gl/gl_context.h"

namespace kaz::sim {

Result<std::unique_ptr<GlContext>> make_osmesa_context();

}  // namespace kaz::sim
