// The module with the reader of worlds, and its loader.
// SPDX-License-Identifier: Apache-2.0
//
// A program linked with libsdformat needs 20 ms at each start for its static data (docs/decisions.md, 100).
// Two libraries therefore define load_world() of world_model.h. kaz::world_reader calls libsdformat.
// kaz::world_loader calls the same function in the module lib/kaz/world_reader.so. Programs link the former,
// unless their CMake target has the property KAZ_LOADS_WORLD_READER (sim/body/CMakeLists.txt).
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "sim/body/description/world_model.h"

namespace kaz::sim {

struct WorldModule {
  // KAZ_INTERFACE_ID of the module's build. `interface` is the first member in every version of WorldModule.
  const char* interface;
  Result<WorldModel> (*load)(const std::string& sdf_path, const ReadOptions& options);
};
inline constexpr const char* kWorldModuleSymbol = "kaz_world_module";

// Loads the module at `module`, and returns the result of its load_world(). The module stays loaded. Further
// errors (environment): the module or a library that it needs is missing, or the module belongs to another
// build. In kaz::world_loader.
Result<WorldModel> load_world_by(const std::string& module, const std::string& sdf_path,
                                 const ReadOptions& options = {});

}  // namespace kaz::sim
