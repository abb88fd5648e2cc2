// Runs independent jobs on several threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "shared/base/result.hpp"

namespace kaz::trials {

// Calls work(i) once for each i in 0..count-1 on `threads` threads. Each function that work() returns runs
// under a lock, to store the result and report progress. Returns their first error; no job starts after it.
Result<void> run_jobs(std::size_t count, int threads,
                      const std::function<std::function<Result<void>()>(std::size_t)>& work);

}  // namespace kaz::trials
