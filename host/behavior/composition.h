// Composition of tasks: sequence, fallback, retry and time limit, as in behaviour trees.
// SPDX-License-Identifier: Apache-2.0
//
// A task is any function of Context that returns an Outcome. Each step's name is reported to the sink as
// a phase of `behavior` when the step begins. An Error (link lost, interrupted) ends the composition at
// once; only an outcome without success is retried or replaced.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/behavior/behavior.h"

namespace kaz::behavior {

using Task = std::function<Result<Outcome>(Context&)>;

struct Step {
  std::string name;  // of its phase in the sink
  Task run;
};

// Runs the steps in order until one fails; its outcome is returned. The measurements of all steps that
// ran are kept. Without steps: success.
Task sequence(std::string behavior, std::vector<Step> steps);
// Runs the steps in order until one succeeds; returns its outcome, or the last one's.
Task fallback(std::string behavior, std::vector<Step> steps);
// Repeats the task until it succeeds, at most `times` (>= 1) times. `retriable` decides for an outcome
// without success whether another try makes sense; empty: always. Adds the measurement "tries".
Task retry(int times, Task task, std::function<bool(const Outcome&)> retriable = {});
// Time limit: an outcome with the cause "time" if the task has not finished. Detected when the task next
// waits on Context::clock.
Task within(Time limit, Task task);

}  // namespace kaz::behavior
