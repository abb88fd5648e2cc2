// Records what a behavior reports, and shows its progress.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "host/behavior/behavior.h"
#include "host/behavior/sink.h"
#include "tools/base/output.h"
#include "tools/drawing/figure.h"
#include "tools/run/backend.h"
#include "tools/run/moments.h"
#include "tools/run/run_observer.h"
#include "tools/run/score.h"
#include "tools/run/snapshots.h"

namespace kaz::tools {

// Writes a behavior's reports to the recording, samples the ground truth for the score, takes snapshots, and
// prints progress. Passes all reports on to the run's observer.
class RunRecorder final : public behavior::Sink {
 public:
  // Begins a run now, in which `behavior` works for `expected_s`. The references must outlive this object.
  RunRecorder(SessionBackend& backend, RunObserver& observer, Snapshots& snapshots,
              const behavior::Behavior& behavior, const std::string& label, bool quiet,
              double expected_s);

  void phase(Time time, std::string_view behavior, std::string_view phase) override;
  void cycle(const behavior::CycleRow& row) override;
  void picture(const behavior::PictureRow& row) override;
  void map(const behavior::MapReport& report) override;
  // Records a request to the behavior, so that a replay can repeat the request.
  void request(const std::string& line) { record({{"request", line}}); }

  Progress& progress() { return progress_; }
  // Time at which the run began.
  Time start() const { return start_; }
  const behavior::Recording& recording() const { return recording_; }
  // Returns the newest map; empty if the behavior has no map.
  const std::optional<figure::Image>& map() const { return map_; }
  // Returns null if the robot is not simulated in this process.
  const TruthProbe* probe() const { return probe_ ? &*probe_ : nullptr; }

 private:
  void record(const nlohmann::ordered_json& value);
  // Returns the milestones of the running behavior, or of a built-in behavior that it calls.
  std::span<const behavior::Milestone> milestones_of(std::string_view name) const;

  SessionBackend& backend_;
  RunObserver& observer_;
  Snapshots& snapshots_;
  const behavior::Behavior& behavior_;
  Progress progress_;
  Time start_;
  std::string phase_;
  Moments moments_;
  std::optional<TruthProbe> probe_;
  behavior::Recording recording_;
  std::optional<figure::Image> map_;
};

}  // namespace kaz::tools
