// Sink of a behaviour's reports, cycle by cycle: for recordings, plots and live displays.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "shared/base/time.hpp"

namespace kaz::map {
class LocalMap;
}

namespace kaz::behavior {

// One control cycle of the head. Angles in rad, pan positive to the left, tilt positive down.
struct CycleRow {
  Time time{};
  double pan_target = 0, tilt_target = 0;      // sent in this cycle
  double pan_measured = 0, tilt_measured = 0;  // newest state
  bool ball_known = false;                     // else ball_* are undefined
  double ball_pan = 0, ball_tilt = 0;          // estimated angles that centre the ball at `time`
};

// One processed image.
struct PictureRow {
  Time exposure{};
  Time known_at{};  // when the result reached the behaviour
  bool found = false;
  double error_rad = 0;   // angle between the left optical axis and the ball; if found
  double distance_m = 0;  // lens to ball; if found
};

// A map as a behaviour has it. Frame: the foot frame of the start; x ahead, y left. m, rad.
struct MapReport {
  Time time{};
  const map::LocalMap& map;
  Eigen::Vector2d robot{0, 0};
  double heading_rad = 0;
  const std::vector<Eigen::Vector2d>& path;   // corners, from start to goal; empty: none
  const std::vector<Eigen::Vector2d>& trail;  // where it has been
  Eigen::Vector2d goal{0, 0};
};

// All calls come from the thread that runs the behaviour, in order of time.
class Sink {
 public:
  virtual ~Sink() = default;
  // A phase of the behaviour begins: "stand", "search", "track".
  virtual void phase(Time, std::string_view /*behavior*/, std::string_view /*phase*/) {}
  virtual void cycle(const CycleRow&) {}
  virtual void picture(const PictureRow&) {}
  // The map has changed: after each plan, and at the end.
  virtual void map(const MapReport&) {}
};

// Stores all reports in memory.
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
