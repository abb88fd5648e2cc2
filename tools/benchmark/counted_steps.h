// Instructions of a physics step and of finding contacts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/benchmark/benchmark.h"

namespace kaz::bench {

// `dynamics.step_kinstr.*` and `dynamics.collision_kinstr.*`, thousands of instructions. Loading and
// settling are not counted. Nothing where valgrind is missing; a remark says so.
Group counted_steps();

}  // namespace kaz::bench
