// The planner of OMPL, loaded when it is wanted.
// SPDX-License-Identifier: Apache-2.0
//
// A program linked with OMPL spends 10 ms of each start on its libraries (docs/decisions.md, 100). So the
// planner is in a module, lib/kaz/ompl_planner.so beside the program's bin/. It has a copy of what it needs
// of Kaz and exports one symbol, an OmplModule.
#pragma once

#include <memory>
#include <string>

#include "host/plan/ompl_planner.h"

namespace kaz::plan {

struct OmplModule {
  const char* interface;  // KAZ_INTERFACE_ID of its build; the first member in every version
  Result<std::unique_ptr<Planner>> (*make)(const OmplOptions&);
};
inline constexpr const char* kOmplModuleSymbol = "kaz_ompl_module";

// Where the running program has the module.
std::string ompl_module_path();
// make_ompl_planner() of the module at `path`, which stays loaded. Further errors (environment): it is not
// there, is of another build, or needs libraries that are not there.
Result<std::unique_ptr<Planner>> load_ompl_planner(const OmplOptions& options = {},
                                                   const std::string& path = ompl_module_path());

}  // namespace kaz::plan
