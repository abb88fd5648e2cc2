// Records what a behavior reports.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_recorder.h"

#include "tools/run/map_picture.h"

namespace kaz::tools {

RunRecorder::RunRecorder(SessionBackend& backend, RunObserver& observer, Snapshots& snapshots,
                         const behavior::Behavior& behavior, const std::string& label, bool quiet,
                         double expected_s)
    : backend_(backend),
      observer_(observer),
      snapshots_(snapshots),
      behavior_(behavior),
      progress_(label, quiet),
      start_(backend.clock().now()),
      moments_(expected_s) {
  if (backend.simulation() != nullptr) probe_.emplace(*backend.simulation());
}

void RunRecorder::phase(Time time, std::string_view behavior, std::string_view phase) {
  recording_.phase(time, behavior, phase);
  observer_.phase(time, behavior, phase);
  phase_ = phase;
  record({{"behavior", behavior}, {"phase", phase}});
  progress_.announce(seconds(time - start_), phase_);
  if (const auto shown = moments_.on_phase(seconds(time - start_), milestones_of(behavior), phase))
    snapshots_.take(time, *shown);
}

std::span<const behavior::Milestone> RunRecorder::milestones_of(std::string_view name) const {
  if (name == behavior_.name) return behavior_.milestones;
  const auto known = behavior::find_behavior(name);
  return known ? known->milestones : std::span<const behavior::Milestone>();
}

void RunRecorder::cycle(const behavior::CycleRow& row) {
  recording_.cycle(row);
  observer_.cycle(row);
  if (probe_) probe_->sample();
  record({{"pan_target", row.pan_target}, {"tilt_target", row.tilt_target}});
  const double elapsed = seconds(row.time - start_);
  // Not a fraction: for most behaviors, `seconds` is a timeout and not the expected duration.
  progress_.show(elapsed, phase_);
  if (const auto shown = moments_.on_cycle(elapsed)) snapshots_.take(row.time, *shown);
}

void RunRecorder::picture(const behavior::PictureRow& row) {
  recording_.picture(row);
  observer_.picture(row);
  record({{"exposure_ns", row.exposure.count()}, {"found", row.found}, {"error", row.error_rad}});
}

void RunRecorder::map(const behavior::MapReport& report) {
  map_ = map_picture(report);
  observer_.map(report);
  backend_.record_map(recorded_map(report));
}

// Names may contain bytes that are not valid UTF-8.
void RunRecorder::record(const nlohmann::ordered_json& value) {
  backend_.record_behavior(
      value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace kaz::tools
