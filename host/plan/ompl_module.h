// Loads the OMPL planner from a separate module when the user selects this planner.
// SPDX-License-Identifier: Apache-2.0
//
// A program linked with OMPL needs 10 ms at each start to load OMPL's libraries (docs/decisions.md, 100). So
// the planner is in a module (shared/base/module.hpp), lib/kaz/ompl_planner.so, which exports an OmplModule.
#pragma once

#include <memory>
#include <string>

#include "host/plan/ompl_planner.h"

namespace kaz::plan {

struct OmplModule {
  // KAZ_INTERFACE_ID of the module's build. `interface` is the first member in every version of OmplModule.
  const char* interface;
  Result<std::unique_ptr<Planner>> (*make)(const OmplOptions&);
};
inline constexpr const char* kOmplModuleSymbol = "kaz_ompl_module";

// Returns the path of lib/kaz/ompl_planner.so in the installation of the running program.
std::string ompl_module_path();
// Loads the module at `path`, and returns the result of the module's make_ompl_planner(). The module stays
// loaded. Further errors (environment): the module or a library that it needs is missing, or the module
// belongs to another build.
Result<std::unique_ptr<Planner>> load_ompl_planner(const OmplOptions& options = {},
                                                   const std::string& path = ompl_module_path());

}  // namespace kaz::plan
