// Pace of a run that viewers control: pause, steps, and a limit of the run's speed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "shared/base/time.hpp"
#include "tools/viewer/server.h"

namespace kaz::viewer {

class RunPace {
 public:
  // `server` must outlive this object. `channel`: viewers read the pace on this channel of the server;
  // nullopt: the pace is not published. `pace`: maximum ratio of the run's time to real time; 0: no limit.
  // All waits end if `stopped` returns true.
  RunPace(Server& server, std::optional<std::uint32_t> channel, double pace,
          std::function<bool()> stopped)
      : server_(server), channel_(channel), stopped_(std::move(stopped)), pace_(pace) {}

  // Executes `pause`, `go`, `step SECONDS` (above 0, at most 60) or `pace TIMES` (0, or 0.01 to 100). Returns
  // false for other lines. Any thread may call this function.
  bool obey(const std::string& line);
  // Waits as long as the run at `time` is paused or too fast. Call this function on the run's thread.
  void keep(Time time);

 private:
  void publish(Time time, bool paused, double pace);

  Server& server_;
  const std::optional<std::uint32_t> channel_;
  const std::function<bool()> stopped_;
  std::optional<std::pair<std::chrono::steady_clock::time_point, Time>> start_;
  std::optional<std::pair<bool, double>> published_;  // paused or not, and pace

  std::mutex mutex_;  // guards the members below
  bool paused_ = false;
  std::optional<double> step_s_;  // requested step that has not begun yet
  std::optional<Time> pause_at_;  // time of the run at which the run pauses
  double pace_, kept_pace_ = 0;
};

}  // namespace kaz::viewer
