// Instructions that this machine executes for a load, counted by its own counter or by valgrind.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "tools/benchmark/benchmark.h"

namespace kaz::bench {

// What `many` takes more than `few` (amounts of a load), so that start-up does not count. Nothing
// where neither way works; a remark in `results` says why.
std::optional<double> host_instructions(const std::string& load, const std::string& engine, int few,
                                        int many, Results& results);

}  // namespace kaz::bench
