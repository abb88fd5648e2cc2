// Loads the reader of worlds from a separate module when the program reads a world.
// SPDX-License-Identifier: Apache-2.0
//
// A program linked with libsdformat needs 20 ms at each start for libsdformat's static data. So the program
// `kaz` defines load_world() of sim/body/description/world_model.h itself (world_loader.cpp). Its definition
// calls the same function in the module lib/kaz/world_reader.so. The linker takes the definition of an object
// file before that of libkaz_body.a, and option --as-needed then leaves out libsdformat. Other programs use
// load_world() of libkaz_body.a.
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "sim/body/description/world_model.h"

namespace kaz::tools {

struct WorldModule {
  // KAZ_INTERFACE_ID of the module's build. `interface` is the first member in every version of WorldModule.
  const char* interface;
  Result<sim::WorldModel> (*load)(const std::string& sdf_path);
};
inline constexpr const char* kWorldModuleSymbol = "kaz_world_module";

// Loads the module at `module`, and returns the result of its load_world(sdf_path). The module stays loaded.
// Further errors (environment): the module or a library that it needs is missing, or the module belongs to
// another build.
Result<sim::WorldModel> load_world_by(const std::string& module, const std::string& sdf_path);

}  // namespace kaz::tools
