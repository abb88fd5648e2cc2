// Selects the OpenGL backend. Only this file knows all of them.
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <mutex>
#include <string>

#include "sim/render/gl/gl_context.h"
#include "sim/render/gl/gl_renderer.h"

namespace kaz::sim {

namespace {

Result<std::unique_ptr<GlContext>> first_that_starts() {
  auto osmesa = make_osmesa_context();
  if (osmesa) return osmesa;
  auto egl = make_egl_context();
  if (egl) return egl;
  return fail(Fault::environment, osmesa.error().message + "; " + egl.error().message);
}

}  // namespace

void fix_mesa_environment() {
  static std::once_flag once;
  std::call_once(once, [] {
    setenv("GALLIUM_DRIVER", "llvmpipe", 1);
    setenv("LIBGL_ALWAYS_SOFTWARE", "true", 1);  // by EGL, a graphics card would come first
    // 0: rasterise in the calling thread. The caller has its own use for the other cores.
    setenv("LP_NUM_THREADS", "0", 1);
    // The width of its vectors decides how its sums are rounded. 512 crashes in Mesa 22.3.
    setenv("LP_NATIVE_VECTOR_WIDTH", __builtin_cpu_supports("avx") ? "256" : "128", 1);
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);  // leaves no files in the user's home
  });
}

Result<std::unique_ptr<Renderer>> make_renderer(const std::string& backend) {
  fix_mesa_environment();
  if (backend.empty()) return make_gl_renderer(first_that_starts);
  if (backend == "osmesa") return make_gl_renderer(make_osmesa_context);
  if (backend == "egl") return make_gl_renderer(make_egl_context);
  return fail(Fault::usage,
              "OpenGL backend \"" + backend + "\": KAZ_OPENGL must be osmesa, egl or unset");
}

Result<std::unique_ptr<Renderer>> make_opengl_renderer() {
  const char* backend = std::getenv("KAZ_OPENGL");
  return make_renderer(backend == nullptr ? "" : backend);
}

}  // namespace kaz::sim
