// OSMesa context: a 1 x 1 default framebuffer, since all drawing goes to framebuffer objects.
// The library is loaded at the first context: with LLVM, which it brings, it would take every start of a
// program another 27 ms.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/gl/gl_context.h"

#ifdef KAZ_HAVE_OSMESA
#include <GL/osmesa.h>
#endif

#include <dlfcn.h>

#include <array>
#include <cstdint>
#include <mutex>
#include <string>
#include <type_traits>

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

struct Osmesa {
  decltype(&OSMesaCreateContextAttribs) create = nullptr;
  decltype(&OSMesaDestroyContext) destroy = nullptr;
  decltype(&OSMesaMakeCurrent) make_current = nullptr;
  decltype(&OSMesaGetProcAddress) function = nullptr;
};

tl::unexpected<Error> no_osmesa(const std::string& why) {
  return fail(Fault::environment, "off-screen OpenGL with OSMesa is not available: " + why +
                                      "; install libosmesa6, or use EGL (KAZ_OPENGL=egl)");
}

// Under mesa_mutex().
Result<Osmesa> load_osmesa() {
  // Never closed: LLVM leaves handlers behind.
  static void* const library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return no_osmesa("libOSMesa.so.8 is missing");
  Osmesa osmesa;
  const char* missing = nullptr;
  const auto load = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
    if (function == nullptr) missing = name;
  };
  load(osmesa.create, "OSMesaCreateContextAttribs");
  load(osmesa.destroy, "OSMesaDestroyContext");
  load(osmesa.make_current, "OSMesaMakeCurrent");
  load(osmesa.function, "OSMesaGetProcAddress");
  if (missing != nullptr) return no_osmesa(std::string("libOSMesa.so.8 lacks ") + missing);
  return osmesa;
}

class OsmesaContext final : public GlContext {
 public:
  OsmesaContext(const Osmesa& osmesa, OSMesaContext context) : osmesa_(osmesa), context_(context) {}
  ~OsmesaContext() override {
    const std::lock_guard lock(mesa_mutex());
    osmesa_.destroy(context_);
  }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  Result<void> make_current() override {
    const std::lock_guard lock(mesa_mutex());
    if (osmesa_.make_current(context_, buffer_.data(), GL_UNSIGNED_BYTE, 1, 1) == GL_FALSE) {
      return fail(Fault::environment,
                  "off-screen OpenGL (OSMesa) rejected its drawing buffer: check the free memory");
    }
    return {};
  }

  void release() override { osmesa_.make_current(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

  Function function(const char* name) override { return osmesa_.function(name); }

 private:
  Osmesa osmesa_;
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
  const Osmesa osmesa = KAZ_TRY(load_osmesa());
  OSMesaContext context = osmesa.create(attributes.data(), nullptr);
  if (context == nullptr)
    return no_osmesa("OSMesa provides no OpenGL 3.3 context: install Mesa 22.3 or newer");
  return std::make_unique<OsmesaContext>(osmesa, context);
}

#else

Result<std::unique_ptr<GlContext>> make_osmesa_context() {
  return fail(Fault::environment,
              "off-screen OpenGL with OSMesa is not built in: build with libosmesa6-dev, or use "
              "EGL (KAZ_OPENGL=egl)");
}

#endif

}  // namespace kaz::sim
