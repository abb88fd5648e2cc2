// Behaviours out of behaviours: in order, again, instead, and not for ever.
// SPDX-License-Identifier: Apache-2.0
//
// A task is any plain function against Context that ends with an Outcome. Each step's name is told to
// the sink as a phase of `behavior` when it begins. An Error (link gone, interrupted) ends all of it at
// once: only an outcome without success is tried again or replaced.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/behavior/behavior.h"

namespace kaz::behavior {

using Task = std::function<Result<Outcome>(Context&)>;

struct Step {
  std::string name;  // as told to the sink
  Task run;
};

// One after the other; the first that fails ends it, and its outcome is the whole's. The figures of
// all steps that ran are kept. No steps: success.
Task sequence(std::string behavior, std::vector<Step> steps);
// The first that succeeds; else the last one's outcome.
Task fallback(std::string behavior, std::vector<Step> steps);
// Until it succeeds, at most `times` (1 or more); `worth` says of an outcome without success whether
// another try makes sense. The figure "tries" is added.
Task retry(int times, Task task, std::function<bool(const Outcome&)> worth = {});
// An outcome with the cause "time" once the clock has gone on so far: noticed where the task waits
// next through Context::clock.
Task within(Time limit, Task task);

}  // namespace kaz::behavior
