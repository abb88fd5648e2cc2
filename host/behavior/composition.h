// Composition of tasks as in behavior trees: sequence, fallback, retry and time limit.
// SPDX-License-Identifier: Apache-2.0
//
// A task is any function of Context that returns an Outcome. When a step begins, the step's name is reported
// to the sink as a phase of `behavior`. An Error (link lost, interrupted) ends the composition at once. Only
// an outcome without success leads to a retry or a fallback.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/behavior/behavior.h"

namespace kaz::behavior {

using Task = std::function<Result<Outcome>(Context&)>;

struct Step {
  std::string name;  // reported to the sink as the name of the phase
  Task run;
};

// Runs the steps in order until a step fails. Returns the last outcome, with the measurements of all steps
// that ran. Without steps, returns success.
Task sequence(std::string behavior, std::vector<Step> steps);
// Runs the steps in order until a step succeeds. Returns the outcome of the last step that ran. Without
// steps, returns an outcome without success.
Task fallback(std::string behavior, std::vector<Step> steps);
// Repeats the task until it succeeds, at most `times` (>= 1) times. After an outcome without success, the
// task is repeated only if `retriable` returns true. If `retriable` is empty, the task is repeated after
// every such outcome. Adds the measurement "tries".
Task retry(int times, Task task, std::function<bool(const Outcome&)> retriable = {});
// Runs the task with a time limit. If the task exceeds the limit, returns an outcome with the cause "time".
// The limit is only checked when the task waits on Context::clock.
Task within(Time limit, Task task);

}  // namespace kaz::behavior
