// dlopen of the module with OMPL's planner.
// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>

#include <filesystem>
#include <string_view>

#include "host/plan/ompl_module.h"
#include "kaz_interface.h"  // made by tools/repo/gen/source_id.py

namespace kaz::plan {
namespace {

namespace fs = std::filesystem;

Error not_loaded(const std::string& path, const std::string& reason) {
  return {Fault::environment, "the planner ompl cannot be loaded from " + path + " (" + reason +
                                  "): install Kaz and libompl-dev again, or use the planner grid"};
}

}  // namespace

std::string ompl_module_path() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return (program.parent_path().parent_path() / "lib/kaz/ompl_planner.so").string();
}

Result<std::unique_ptr<Planner>> load_ompl_planner(const OmplOptions& options,
                                                   const std::string& path) {
  void* const object = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) {
    const char* const reason = dlerror();
    return tl::unexpected(not_loaded(path, reason == nullptr ? "no reason given" : reason));
  }
  const auto* const module = static_cast<const OmplModule*>(dlsym(object, kOmplModuleSymbol));
  if (module == nullptr || module->interface != std::string_view(KAZ_INTERFACE_ID))
    return tl::unexpected(
        not_loaded(path, "the planner was built with other Kaz headers than this program"));
  return module->make(options);
}

}  // namespace kaz::plan
