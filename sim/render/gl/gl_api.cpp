// Looks up the OpenGL functions in use.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/gl/gl_api.h"

namespace kaz::sim {

Result<Gl> Gl::load(GlContext& context) {
  Gl gl;
  const char* missing = nullptr;
#define KAZ_GL_LOAD(TYPE, Name)                                                \
  gl.Name = reinterpret_cast<PFNGL##TYPE##PROC>(context.function("gl" #Name)); \
  if (gl.Name == nullptr) missing = "gl" #Name;
  KAZ_GL_FUNCTIONS(KAZ_GL_LOAD)
#undef KAZ_GL_LOAD
  if (missing != nullptr) {
    return fail(Fault::environment,
                std::string("this OpenGL lacks ") + missing + ": install Mesa 22.3 or newer");
  }
  return gl;
}

}  // namespace kaz::sim
