// Runs independent jobs on several threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "shared/base/result.hpp"

namespace kaz::studies {

// Calls work(i) once for each i in 0..count-1, on `threads` threads. work() returns a function that stores
// the result and reports progress. A lock ensures that only one of these functions runs at a time. If such a
// function returns an error, run_jobs() starts no further job and returns the first error.
Result<void> run_jobs(std::size_t count, int threads,
                      const std::function<std::function<Result<void>()>(std::size_t)>& work);

}  // namespace kaz::studies
