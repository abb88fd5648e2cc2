// Modules: shared objects in lib/kaz that a program loads when it needs them.
// SPDX-License-Identifier: Apache-2.0
//
// A module contains a copy of all Kaz code that it needs, and exports one symbol. The symbol is a struct
// whose first member is `const char* interface`, the KAZ_INTERFACE_ID of the module's build.
#ifndef KAZ_SHARED_BASE_MODULE_HPP
#define KAZ_SHARED_BASE_MODULE_HPP

#include <dlfcn.h>

#include <filesystem>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace kaz {

// Returns the path of lib/kaz/`name` in the installation of the running program. The folder lib/ is beside
// the program's folder bin/.
inline std::string module_path(const std::string& name) {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return (program.parent_path().parent_path() / "lib/kaz" / name).string();
}

// Loads the module at `path`, and returns its exported `symbol`. The module stays loaded. An error is the
// reason, without the path: a file is missing, or the module belongs to another build than `interface`. The
// latter reason begins with `what`. Thread-safe.
template <class Module>
tl::expected<const Module*, std::string> load_module(const std::string& path, const char* symbol,
                                                     std::string_view interface,
                                                     const std::string& what) {
  void* const object = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) {
    const char* const reason = dlerror();
    return tl::unexpected<std::string>(reason == nullptr ? "no reason given" : reason);
  }
  const auto* const module = static_cast<const Module*>(dlsym(object, symbol));
  if (module == nullptr || module->interface != interface)
    return tl::unexpected(what + " was built with other Kaz headers than this program");
  return module;
}

}  // namespace kaz

#endif
