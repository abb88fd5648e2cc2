// EGL without a display server or a surface. libEGL is loaded by name, not linked: who draws
// by OSMesa or the rasteriser needs none.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/gl/gl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <cstring>
#include <string>

namespace kaz::sim {

namespace {

#define KAZ_EGL_FUNCTIONS(X) \
  X(GetError)                \
  X(QueryString)             \
  X(Initialize)              \
  X(BindAPI)                 \
  X(CreateContext)           \
  X(DestroyContext)          \
  X(MakeCurrent)             \
  X(GetProcAddress)          \
  X(GetPlatformDisplay)

struct Egl {
#define KAZ_EGL_MEMBER(Name) decltype(&egl##Name) Name = nullptr;
  KAZ_EGL_FUNCTIONS(KAZ_EGL_MEMBER)
#undef KAZ_EGL_MEMBER
};

tl::unexpected<Error> no_egl(const std::string& why) {
  return fail(Fault::environment, "off-screen OpenGL with EGL is not available: " + why +
                                      "; install libegl1 and libegl-mesa0, or use OSMesa "
                                      "(KAZ_OPENGL=osmesa)");
}

Result<Egl> load_egl() {
  // Never closed: Mesa's drivers leave threads and handlers behind.
  static void* const library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return no_egl("libEGL.so.1 is missing");
  Egl egl;
  const char* missing = nullptr;
#define KAZ_EGL_LOAD(Name)                                                      \
  egl.Name = reinterpret_cast<decltype(egl.Name)>(dlsym(library, "egl" #Name)); \
  if (egl.Name == nullptr) missing = "egl" #Name;
  KAZ_EGL_FUNCTIONS(KAZ_EGL_LOAD)
#undef KAZ_EGL_LOAD
  if (missing != nullptr) return no_egl(std::string("libEGL.so.1 lacks ") + missing);
  return egl;
}

class EglGlContext final : public GlContext {
 public:
  EglGlContext(const Egl& egl, EGLDisplay display, EGLContext context)
      : egl_(egl), display_(display), context_(context) {}
  // The display is the process's: eglTerminate would end the other contexts too.
  ~EglGlContext() override { egl_.DestroyContext(display_, context_); }
  EglGlContext(const EglGlContext&) = delete;
  EglGlContext& operator=(const EglGlContext&) = delete;

  Result<void> make_current() override {
    // The API bound is each thread's own.
    if (egl_.BindAPI(EGL_OPENGL_API) == EGL_FALSE ||
        egl_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
      return no_egl("a context cannot become current (error " + std::to_string(egl_.GetError()) +
                    ")");
    }
    return {};
  }

  void release() override {
    egl_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

  Function function(const char* name) override { return egl_.GetProcAddress(name); }

 private:
  Egl egl_;
  EGLDisplay display_;
  EGLContext context_;
};

}  // namespace

Result<std::unique_ptr<GlContext>> make_egl_context() {
  const Result<Egl> egl = load_egl();
  if (!egl) return tl::unexpected(egl.error());
  const char* extensions = egl->QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (extensions == nullptr ||
      std::strstr(extensions, "EGL_MESA_platform_surfaceless") == nullptr) {
    return no_egl("EGL has no EGL_MESA_platform_surfaceless");
  }
  EGLDisplay display =
      egl->GetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || egl->Initialize(display, nullptr, nullptr) == EGL_FALSE)
    return no_egl("no driver starts");
  if (egl->BindAPI(EGL_OPENGL_API) == EGL_FALSE) return no_egl("EGL has no desktop OpenGL");
  constexpr EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                   3,
                                   EGL_CONTEXT_MINOR_VERSION,
                                   3,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_NONE};
  EGLContext context = egl->CreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) return no_egl("EGL provides no OpenGL 3.3 context");
  return std::make_unique<EglGlContext>(*egl, display, context);
}

}  // namespace kaz::sim
