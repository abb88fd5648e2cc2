// Camera and vision of a run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "host/behavior/vision.h"
#include "host/camera/capture.h"
#include "host/robot/robot.h"
#include "tools/run/backend.h"
#include "tools/run/run_observer.h"
#include "tools/run/run_plan.h"
#include "tools/run/snapshots.h"
#include "tools/vision/report.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::tools {

class RunEyes {
 public:
  // Opens the backend's camera, and adds the plan's modules to a pipeline. Fails if the behavior needs a
  // camera and the backend has none. All arguments must outlive the returned object.
  static Result<std::unique_ptr<RunEyes>> open(const RunPlan& plan, RunObserver& observer,
                                               SessionBackend& backend, host::Robot& robot);
  RunEyes(const RunEyes&) = delete;
  RunEyes& operator=(const RunEyes&) = delete;

  // Ends the pipeline after the last picture. Call end() once.
  void end();

  vision::Pipeline& pipeline() { return *pipeline_; }
  const DeliveryTable& deliveries() const { return deliveries_; }
  Snapshots& snapshots() { return snapshots_; }
  // Returns Context::vision of the behavior: null if the backend has no camera.
  behavior::Vision* behavior_vision() { return sees_ ? &vision_ : nullptr; }

 private:
  RunEyes(const RunPlan& plan, RunObserver& observer, SessionBackend& backend, host::Robot& robot,
          std::unique_ptr<vision::Pipeline> pipeline);

  RunObserver& observer_;
  bool sees_;
  RememberingCamera camera_;
  host::Capture capture_;
  std::unique_ptr<vision::Pipeline> pipeline_;
  DeliveryTable deliveries_;
  behavior::PipelineVision vision_;
  Snapshots snapshots_;
};

}  // namespace kaz::tools
