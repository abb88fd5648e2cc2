// Targets out, observations in, both logged.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/head_control.h"

namespace kaz::behavior {

HeadControl::HeadControl(Context& context, std::string_view behavior)
    : context_(&context), behavior_(behavior), cycle_(context) {}

Result<HeadControl> HeadControl::begin(Context& context, std::string_view behavior) {
  if (!context.vision) {
    return fail(Fault::usage, std::string(behavior) + " needs a camera: give one with --camera");
  }
  KAZ_TRY(hold_still(context.robot));
  HeadControl head(context, behavior);
  auto input = head.cycle_.next({});
  if (!input) return tl::unexpected(input.error());
  head.input_ = std::move(*input);
  head.process(head.input_.observations);
  return head;
}

Result<void> HeadControl::step(const host::Gaze& target) {
  KAZ_TRY(step_once(target));
  if (!camera_lost()) return {};
  phase("wait for the camera");
  while (camera_lost()) KAZ_TRY(step_once(target));
  return {};
}

Result<void> HeadControl::step_once(const host::Gaze& target) {
  const host::Gaze reachable = host::within_limits(target, kMargin);
  CycleRow row;
  row.time = now();
  row.pan_target = reachable.pan_rad;
  row.tilt_target = reachable.tilt_rad;
  row.pan_measured = measured().pan_rad;
  row.tilt_measured = measured().tilt_rad;
  context_->sink.cycle(row);

  const host::JointTarget targets[] = {{host::neck_pan, reachable.pan_rad},
                                       {host::neck_tilt, reachable.tilt_rad}};
  auto input = KAZ_TRY(cycle_.next(targets));
  input_ = std::move(input);
  process(input_.observations);
  return {};
}

void HeadControl::process(const std::vector<vision::BallObservation>& observations) {
  for (const vision::BallObservation& observation : observations) {
    if (observation.found) ball_ = observation;
    consecutive_ = observation.found ? consecutive_ + 1 : 0;
    newest_exposure_ = observation.info.exposure;
    tracker_.observe(observation);
    pictures_.push_back(picture_row(observation));
    context_->sink.picture(pictures_.back());
  }
}

}  // namespace kaz::behavior
