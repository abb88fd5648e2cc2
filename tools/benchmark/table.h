// The results for people (a table) and for programs (one JSON object).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/benchmark/benchmark.h"

namespace kaz::bench {

// Rows in the order of names(), with what is due and aimed at beside.
std::string table(const Results& results, const std::vector<std::string>& engines);
// A number a name. The file appears whole or not at all.
Result<void> write_json(const std::string& path, const Results& results,
                        const std::vector<std::string>& engines);

}  // namespace kaz::bench
