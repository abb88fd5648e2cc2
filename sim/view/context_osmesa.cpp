// OSMesa context: a 1 x 1 default framebuffer, since all drawing goes to framebuffer objects.
// SPDX-License-Identifier: Apache-2.0
#include "sim/view/context_osmesa.h"

#include <GL/osmesa.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <mutex>

#include "sim/view/gl_renderer.h"

// Leaks of libraries, not ours, that the leak checker would report: Mesa keeps 160 bytes of each
// context, fontconfig its patterns. Weak, for another library of ours may bring the same list.
#if defined(__SANITIZE_ADDRESS__)
extern "C" const char* __lsan_default_suppressions();
extern "C" [[gnu::weak]] const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\nleak:libfontconfig.so\n";
}
#endif

namespace kaz::sim {

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

void fix_mesa_environment() {
  static std::once_flag once;
  std::call_once(once, [] {
    setenv("GALLIUM_DRIVER", "llvmpipe", 1);
    // 0: rasterise in the calling thread. The caller has its own use for the other cores.
    setenv("LP_NUM_THREADS", "0", 1);
    // The width of its vectors decides how its sums are rounded. 512 crashes in Mesa 22.3.
    setenv("LP_NATIVE_VECTOR_WIDTH", __builtin_cpu_supports("avx") ? "256" : "128", 1);
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);  // leaves no files in the user's home
  });
}

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

Result<std::unique_ptr<Renderer>> make_osmesa_renderer() {
  fix_mesa_environment();
  return make_gl_renderer(make_osmesa_context);
}

}  // namespace kaz::sim
