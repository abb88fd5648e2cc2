// Loads the module with the reader of worlds, and reads worlds with it.
// SPDX-License-Identifier: Apache-2.0
#include "kaz_interface.h"  // made by tools/repo/gen/source_id.py
#include "shared/base/module.hpp"
#include "sim/body/description/world_module.h"

namespace kaz::sim {

Result<WorldModel> load_world_by(const std::string& module, const std::string& sdf_path,
                                 const ReadOptions& options) {
  const auto loaded =
      load_module<WorldModule>(module, kWorldModuleSymbol, KAZ_INTERFACE_ID, "the reader");
  if (!loaded)
    return fail(Fault::environment, "the reader of worlds cannot be loaded from " + module + " (" +
                                        loaded.error() +
                                        "): install Kaz and libsdformat-dev again");
  return (*loaded)->load(sdf_path, options);
}

Result<WorldModel> load_world(const std::string& sdf_path, const ReadOptions& options) {
  return load_world_by(module_path("world_reader.so"), sdf_path, options);
}

}  // namespace kaz::sim
