// Executes the pace settings of viewers, and makes the run wait.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/run_pace.h"

#include <algorithm>
#include <string_view>
#include <thread>

#include <nlohmann/json.hpp>

#include "shared/base/number_text.hpp"

namespace kaz::viewer {

bool RunPace::obey(const std::string& line) {
  const std::lock_guard lock(mutex_);
  const auto number_after = [&line](std::string_view verb) {
    return line.starts_with(verb) ? parse_number<double>(std::string_view(line).substr(verb.size()))
                                  : std::nullopt;
  };
  if (line == "pause" || line == "go") {
    pause_at_.reset();
    paused_ = line == "pause";
    step_s_.reset();
    return true;
  }
  if (const auto seconds = number_after("step "); seconds && *seconds > 0 && *seconds <= 60) {
    step_s_ = *seconds;
    return true;
  }
  // 0: as fast as it goes; else as --pace takes it.
  const auto times = number_after("pace ");
  if (times && (*times == 0 || (*times >= 0.01 && *times <= 100))) {
    pace_ = *times;
    return true;
  }
  return false;
}

// To all viewers, whichever of them changed it; called on the run's thread.
void RunPace::publish(Time time, bool paused, double pace) {
  const std::pair now{paused, pace};
  if (!channel_ || published_ == now) return;
  published_ = now;
  const std::string text = nlohmann::ordered_json{{"paused", paused}, {"pace", pace}}.dump();
  server_.publish(*channel_, static_cast<std::uint64_t>(time.count()),
                  {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()},
                  {.kept = true});
}

// Stops where a viewer wants it, and else goes no faster than the pace.
void RunPace::keep(Time time) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kNap{20};
  double pace = 0;
  bool paused = true;
  while (paused) {
    {
      const std::lock_guard lock(mutex_);
      if (step_s_) {
        pause_at_ = time + from_seconds(*std::exchange(step_s_, std::nullopt));
        paused_ = false;
      }
      if (pause_at_ && time >= *pause_at_) {
        paused_ = true;
        pause_at_.reset();
      }
      if (std::exchange(kept_pace_, pace_) != pace_) start_.reset();
      pace = pace_;
      paused = paused_;
      if (paused) start_.reset();
    }
    publish(time, paused, pace);
    if (!paused) break;
    if (stopped_()) return;
    std::this_thread::sleep_for(kNap);
  }
  if (pace <= 0) return;
  const auto now = Clock::now();
  if (!start_) start_.emplace(now, time);
  const auto due =
      start_->first +
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::nano>(
          static_cast<double>((time - start_->second).count()) / pace));
  // Lost time is not made up for.
  if (now > due + std::chrono::milliseconds(100)) start_.emplace(now, time);
  while (Clock::now() < due && !stopped_())
    std::this_thread::sleep_for(std::min<Clock::duration>(due - Clock::now(), kNap));
}

}  // namespace kaz::viewer
