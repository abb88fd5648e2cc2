// Where behaviours report what they do, cycle by cycle: for records, plots and live displays.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "vision/image/frame.h"  // Time

namespace kaz::behavior {

// One control cycle of the head. Angles in rad, pan positive to the left, tilt positive down.
struct CycleRow {
  Time time{};
  double pan_target = 0, tilt_target = 0;      // sent to the board in this cycle
  double pan_measured = 0, tilt_measured = 0;  // the newest state, as the potentiometers say
  bool ball_known = false;                     // the rest means nothing where false
  double ball_pan = 0, ball_tilt = 0;  // angles that would centre the ball at `time`, as estimated
};

// One picture that was looked at.
struct PictureRow {
  Time exposure{};
  Time known_at{};  // when its result reached the behaviour
  bool found = false;
  double error_rad = 0;   // angle between the left eye's optical axis and the ball; where found
  double distance_m = 0;  // lens to ball; where found
};

// All calls come from the thread that runs the behaviour, in order of time.
class Sink {
 public:
  virtual ~Sink() = default;
  // A behaviour began something: "stand", "search", "track".
  virtual void phase(Time, std::string_view /*behavior*/, std::string_view /*phase*/) {}
  virtual void cycle(const CycleRow&) {}
  virtual void picture(const PictureRow&) {}
};

// Keeps everything.
class Recording final : public Sink {
 public:
  struct Phase {
    Time time{};
    std::string behavior, phase;
  };
  void phase(Time time, std::string_view behavior, std::string_view phase) override {
    phases.push_back({time, std::string(behavior), std::string(phase)});
  }
  void cycle(const CycleRow& row) override { cycles.push_back(row); }
  void picture(const PictureRow& row) override { pictures.push_back(row); }

  std::vector<Phase> phases;
  std::vector<CycleRow> cycles;
  std::vector<PictureRow> pictures;
};

}  // namespace kaz::behavior
