// Composition of tasks as in behavior trees: sequence, fallback, retry and time limit.
// SPDX-License-Identifier: Apache-2.0
//
// A task is any function of Context that returns an Outcome. When a step begins, its name is reported to
// the sink as a phase of `behavior`. An Error (link lost, interrupted) ends the composition at once. Only
// an outcome without success is retried or replaced.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/behavior/behavior.h"

namespace kaz::behavior {

using Task = std::function<Result<Outcome>(Context&)>;

struct Step {
  std::string name;  // name of its phase in the sink
  Task run;
};

// Runs the steps in order until one fails, and returns the last outcome with the measurements of all steps
// that ran. Without steps: success.
Task sequence(std::string behavior, std::vector<Step> steps);
// Runs the steps in order until one succeeds. Returns its outcome, or that of the last step. Without steps:
// no success.
Task fallback(std::string behavior, std::vector<Step> steps);
// Repeats the task until it succeeds, at most `times` (>= 1) times. `retriable` returns whether an outcome
// without success is worth another try; empty: always. Adds the measurement "tries".
Task retry(int times, Task task, std::function<bool(const Outcome&)> retriable = {});
// Runs the task with a time limit. If it is exceeded, returns an outcome with the cause "time". The limit
// is detected when the task next waits on Context::clock.
Task within(Time limit, Task task);

}  // namespace kaz::behavior
