// Runs independent jobs on several threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "shared/base/result.hpp"

namespace kaz::trials {

// Calls work(i) once for each i in 0..count-1, on `threads` threads. work() returns a function that stores
// the result and reports progress. These functions run under a lock. run_jobs() returns the first error of a
// function and starts no job after the error.
Result<void> run_jobs(std::size_t count, int threads,
                      const std::function<std::function<Result<void>()>(std::size_t)>& work);

}  // namespace kaz::trials
