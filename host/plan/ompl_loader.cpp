// Loads the module with OMPL's planner.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/ompl_module.h"
#include "kaz_interface.h"  // made by tools/repo/gen/source_id.py
#include "shared/base/module.hpp"

namespace kaz::plan {

std::string ompl_module_path() {
  return module_path("ompl_planner.so");
}

Result<std::unique_ptr<Planner>> load_ompl_planner(const OmplOptions& options,
                                                   const std::string& path) {
  const auto module =
      load_module<OmplModule>(path, kOmplModuleSymbol, KAZ_INTERFACE_ID, "the planner");
  if (!module)
    return fail(Fault::environment,
                "the planner ompl cannot be loaded from " + path + " (" + module.error() +
                    "): install Kaz and libompl-dev again, or use the planner grid");
  return (*module)->make(options);
}

}  // namespace kaz::plan
