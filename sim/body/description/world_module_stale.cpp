// For the test of the loader: a module of another build.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/world_module.h"

extern "C" __attribute__((visibility("default"))) const kaz::sim::WorldModule kaz_world_module;
const kaz::sim::WorldModule kaz_world_module{"another", nullptr};
