// Runs one behavior on a robot from start to end, and writes the results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "tools/run/run_observer.h"
#include "tools/run/run_plan.h"

namespace kaz::tools {

// Runs the plan's behavior. Locks the results folder (output_file.h) before opening a device. Always switches
// the motors off at the end. Returns:
// - true: the behavior succeeded.
// - false: the behavior did not succeed, or returned Fault::failed, for example because the board switched
//   its motors off. The report is complete; after Fault::failed, the cause in the report is `error`. Also
//   false, without a report, if the run ended at RunOptions::until.
// - Fault::interrupted: a signal ended the run. result.json and the recording cover the time until the
//   signal, and are marked as interrupted.
// - Fault::environment with a complete report: a run at a port did not succeed while this program or the
//   simulator was late (run_lateness.h). The outcome in the report is `environment`.
// - Other errors: the run broke off. The recording of the run is kept. If the machine was the cause,
//   result.json has the outcome `environment`. If the behavior threw an exception, result.json has the
//   outcome `failed` and the cause `crashed`.
// If a plug-in crashes, the process ends at once, and the board's link watchdog stops the robot.
Result<bool> run(const RunPlan& plan, RunObserver& observer);
// Calls RunPlan::make() and run().
Result<bool> run(RunOptions options, RunObserver& observer);

}  // namespace kaz::tools
