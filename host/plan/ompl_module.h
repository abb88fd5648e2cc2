// Loads the OMPL planner from a module when it is selected.
// SPDX-License-Identifier: Apache-2.0
//
// A program linked with OMPL spends 10 ms of each start on its libraries (docs/decisions.md, 100). So the
// planner is in a module, lib/kaz/ompl_planner.so beside the program's bin/. The module has a copy of the
// Kaz code that it uses, and exports one symbol, an OmplModule.
#pragma once

#include <memory>
#include <string>

#include "host/plan/ompl_planner.h"

namespace kaz::plan {

struct OmplModule {
  // KAZ_INTERFACE_ID of the module's build. It is the first member in every version.
  const char* interface;
  Result<std::unique_ptr<Planner>> (*make)(const OmplOptions&);
};
inline constexpr const char* kOmplModuleSymbol = "kaz_ompl_module";

// Returns the path of the running program's module.
std::string ompl_module_path();
// Runs make_ompl_planner() of the module at `path`, which stays loaded. Further errors (environment): the
// module or a library that it needs is missing, or it belongs to another build.
Result<std::unique_ptr<Planner>> load_ompl_planner(const OmplOptions& options = {},
                                                   const std::string& path = ompl_module_path());

}  // namespace kaz::plan
