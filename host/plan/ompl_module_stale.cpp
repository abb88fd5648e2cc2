// For the test of the loader: a module of another build.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/ompl_module.h"

extern "C" __attribute__((visibility("default"))) const kaz::plan::OmplModule kaz_ompl_module;
const kaz::plan::OmplModule kaz_ompl_module{"another", nullptr};
