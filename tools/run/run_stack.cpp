// Opens everything that a run needs.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_stack.h"

#include "tools/run/run_end.h"

namespace kaz::tools {

Result<std::unique_ptr<RunStack>> RunStack::open(const RunPlan& plan, RunObserver& observer,
                                                 RunFiles& files, host::Interrupt& interrupt) {
  auto robot = KAZ_TRY(RunRobot::open(plan, observer, files.folder(), interrupt));
  auto stack = std::unique_ptr<RunStack>(
      new RunStack{plan, observer, files, interrupt, std::move(robot), nullptr, {}, nullptr});
  SessionBackend& backend = *stack->robot.backend;
  stack->eyes = KAZ_TRY(RunEyes::open(plan, observer, backend, stack->robot.robot));
  if (const auto begun = files.begin(); !begun) {
    if (begun.error().fault != Fault::environment) return tl::unexpected(begun.error());
    return tl::unexpected(lost(*stack, RunEnd{}, begun.error()));
  }
  stack->recorder =
      std::make_unique<RunRecorder>(backend, observer, stack->eyes->snapshots(), plan.behavior(),
                                    plan.options().label, plan.options().json, plan.expected_s());
  if (const auto* simulation = backend.simulation()) stack->start_pose = simulation->world().pose();
  return stack;
}

}  // namespace kaz::tools
