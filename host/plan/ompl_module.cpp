// What the module with OMPL's planner exports.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/ompl_module.h"

#include "kaz_interface.h"  // made by tools/repo/gen/source_id.py

extern "C" __attribute__((visibility("default"))) const kaz::plan::OmplModule kaz_ompl_module;
const kaz::plan::OmplModule kaz_ompl_module{KAZ_INTERFACE_ID, kaz::plan::make_ompl_planner};
