// Observer of a behavior's reports, cycle by cycle: for recordings, plots and live displays.
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

// One control cycle of the head. Angles in rad; pan is positive to the left, tilt positive down.
struct CycleRow {
  Time time{};
  double pan_target = 0, tilt_target = 0;      // sent in this cycle
  double pan_measured = 0, tilt_measured = 0;  // from the newest state
};

// One processed image.
struct PictureRow {
  Time exposure{};
  bool found = false;
  // Angle between the left optical axis and the ball; valid if `found`.
  double error_rad = 0;
  double distance_m = 0;  // from lens to ball; valid if `found`
};

// Snapshot of a behavior's map. Frame: the foot frame at the start of the run; x ahead, y left. Units: m,
// rad. The references are valid during the call of Sink::map() only.
struct MapReport {
  Time time{};
  const map::LocalMap& map;
  Eigen::Vector2d robot{0, 0};
  double heading_rad = 0;
  // Corners of the path from start to goal; empty if there is no path.
  const std::vector<Eigen::Vector2d>& path;
  const std::vector<Eigen::Vector2d>& trail;  // positions of the robot so far
  Eigen::Vector2d goal{0, 0};
};

// Receiver of the data that a behavior reports. All calls come from the thread that runs the behavior, in
// order of time.
class Sink {
 public:
  virtual ~Sink() = default;
  // Called when a phase of the behavior begins: "stand", "search", "track".
  virtual void phase(Time, std::string_view /*behavior*/, std::string_view /*phase*/) {}
  virtual void cycle(const CycleRow&) {}
  virtual void picture(const PictureRow&) {}
  // Called each time a path was planned, and at the end of the behavior.
  virtual void map(const MapReport&) {}
};

// Stores phases, cycles and pictures in memory; ignores maps.
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
