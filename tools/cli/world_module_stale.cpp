// For the test of the loader: a module of another build.
// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/world_module.h"

extern "C" __attribute__((visibility("default"))) const kaz::tools::WorldModule kaz_world_module;
const kaz::tools::WorldModule kaz_world_module{"another", nullptr};
