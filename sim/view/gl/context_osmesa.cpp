// OSMesa context: a 1 x 1 default framebuffer, since all drawing goes to framebuffer objects.
// SPDX-License-Identifier: Apache-2.0
#include "sim/view/gl/gl_context.h"

#ifdef KAZ_HAVE_OSMESA
#include <GL/osmesa.h>
#endif

#include <array>
#include <cstdint>
#include <mutex>

// Leaks of libraries, not ours, that the leak checker would report: Mesa keeps 160 bytes of each
// context, fontconfig its patterns. Weak, for another library of ours may bring the same list.
#if defined(__SANITIZE_ADDRESS__)
extern "C" const char* __lsan_default_suppressions();
extern "C" [[gnu::weak]] const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\nleak:libfontconfig.so\n";
}
#endif

namespace kaz::sim {

#ifdef KAZ_HAVE_OSMESA

namespace {

// Mesa sets up its driver, shared by all contexts, in the first call, without a lock of its own.
std::mutex& mesa_mutex() {
  static std::mutex mutex;
  return mutex;
}

class OsmesaContext final : public GlContext {
 public:
  explicit OsmesaContext(OSMesaContext context) : context_(context) {}
  ~OsmesaContext() override {
    const std::lock_guard lock(mesa_mutex());
    OSMesaDestroyContext(context_);
  }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  Result<void> make_current() override {
    const std::lock_guard lock(mesa_mutex());
    if (OSMesaMakeCurrent(context_, buffer_.data(), GL_UNSIGNED_BYTE, 1, 1) == GL_FALSE) {
      return fail(Fault::environment,
                  "off-screen OpenGL (OSMesa) refused its drawing buffer: check the memory left");
    }
    return {};
  }

  void release() override { OSMesaMakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

  Function function(const char* name) override { return OSMesaGetProcAddress(name); }

 private:
  OSMesaContext context_;
  alignas(16) std::array<std::uint8_t, 64> buffer_{};
};

}  // namespace

Result<std::unique_ptr<GlContext>> make_osmesa_context() {
  constexpr std::array<int, 9> attributes = {OSMESA_FORMAT,
                                             OSMESA_RGBA,
                                             OSMESA_PROFILE,
                                             OSMESA_CORE_PROFILE,
                                             OSMESA_CONTEXT_MAJOR_VERSION,
                                             3,
                                             OSMESA_CONTEXT_MINOR_VERSION,
                                             3,
                                             0};
  const std::lock_guard lock(mesa_mutex());
  OSMesaContext context = OSMesaCreateContextAttribs(attributes.data(), nullptr);
  if (context == nullptr) {
    return fail(
        Fault::environment,
        "off-screen OpenGL (OSMesa) gives no OpenGL 3.3 context: install Mesa 22.3 or newer "
        "(package libosmesa6)");
  }
  return std::make_unique<OsmesaContext>(context);
}

#else

Result<std::unique_ptr<GlContext>> make_osmesa_context() {
  return fail(Fault::environment,
              "off-screen OpenGL by OSMesa was not built in: build with libosmesa6-dev, or use EGL "
              "(KAZ_OPENGL=egl)");
}

#endif

}  // namespace kaz::sim
