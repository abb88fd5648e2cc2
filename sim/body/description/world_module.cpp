// Exports the reader of worlds from its module.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/world_module.h"

#include "kaz_interface.h"  // made by tools/repo/gen/source_id.py

extern "C" __attribute__((visibility("default"))) const kaz::sim::WorldModule kaz_world_module;
const kaz::sim::WorldModule kaz_world_module{KAZ_INTERFACE_ID, kaz::sim::load_world};
