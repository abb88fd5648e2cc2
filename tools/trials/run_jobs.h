// Work shared out over threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "shared/base/result.hpp"

namespace kaz::trials {

// Calls work(i) for i from 0 to count - 1, each once, on so many threads; what it returns is called
// with the lock held, one at a time: there results are kept and progress is told. The first error of
// that ends it: no work begins after it.
Result<void> run_jobs(std::size_t count, int threads,
                      const std::function<std::function<Result<void>()>(std::size_t)>& work);

}  // namespace kaz::trials
