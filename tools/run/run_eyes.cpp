// Opens camera and vision of a run.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_eyes.h"

#include "tools/base/interrupt_signals.h"

namespace kaz::tools {

Result<std::unique_ptr<RunEyes>> RunEyes::open(const RunPlan& plan, RunObserver& observer,
                                               SessionBackend& backend, host::Robot& robot) {
  KAZ_TRY(backend.open_camera());
  if (plan.behavior().needs_camera && !backend.sees())
    return tl::unexpected(sim::Simulation::no_eyes());
  auto pipeline = std::make_unique<vision::Pipeline>(
      vision::PipelineOptions{backend.pace(), backend.camera_latency()});
  KAZ_TRY(add_modules(plan.options().vision, *pipeline));
  return std::unique_ptr<RunEyes>(new RunEyes(plan, observer, backend, robot, std::move(pipeline)));
}

RunEyes::RunEyes(const RunPlan& plan, RunObserver& observer, SessionBackend& backend,
                 host::Robot& robot, std::unique_ptr<vision::Pipeline> pipeline)
    : observer_(observer),
      sees_(backend.sees()),
      camera_(backend.camera(), observer),
      capture_(camera_, robot),
      pipeline_(std::move(pipeline)),
      deliveries_(*pipeline_),
      vision_(capture_, *pipeline_, plan.behavior().needs_floor),
      // Not by the run's interrupt, which also ends a run at RunOptions::until.
      snapshots_(camera_, backend.simulation(), plan.options().vision.ball,
                 [] { return received_signal() != 0; }) {
  observer.begin_vision(*pipeline_);
}

void RunEyes::end() {
  pipeline_->finish();
  observer_.end_vision(*pipeline_);
}

}  // namespace kaz::tools
