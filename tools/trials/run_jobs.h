// Runs independent jobs on several threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "shared/base/result.hpp"

namespace kaz::trials {

// Calls work(i) once for each i in 0..count-1 on `threads` threads. The function that it returns is called
// with a lock held, one at a time: it stores the result and reports progress. Its first error is returned;
// no job starts after it.
Result<void> run_jobs(std::size_t count, int threads,
                      const std::function<std::function<Result<void>()>(std::size_t)>& work);

}  // namespace kaz::trials
