// Everything that a run keeps open while its behavior runs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "host/link/interrupt.h"
#include "tools/run/run_eyes.h"
#include "tools/run/run_files.h"
#include "tools/run/run_observer.h"
#include "tools/run/run_plan.h"
#include "tools/run/run_recorder.h"
#include "tools/run/run_robot.h"

namespace kaz::tools {

// The members refer to earlier members, so they are destroyed in reverse order.
struct RunStack {
  const RunPlan& plan;
  RunObserver& observer;
  RunFiles& files;
  host::Interrupt& interrupt;
  RunRobot robot;
  std::unique_ptr<RunEyes> eyes;
  std::optional<sim::ScenePose> start_pose;  // only for a simulated world
  std::unique_ptr<RunRecorder> recorder;

  // Opens the backend, connects the robot, opens the camera, and begins the results. All arguments must
  // outlive the returned object.
  static Result<std::unique_ptr<RunStack>> open(const RunPlan& plan, RunObserver& observer,
                                                RunFiles& files, host::Interrupt& interrupt);
};

}  // namespace kaz::tools
