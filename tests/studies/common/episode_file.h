// Stores outcomes of a walking robot's episodes in a file of JSON lines, so that a study can be resumed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::studies {

// Outcome of an episode. Poses are those of the trunk relative to the start of the motion; x ahead, y left.
struct Outcome {
  bool fell = false;
  double seconds = 0;                 // duration of the motion, ramps included
  double forward_m = 0, aside_m = 0;  // aside: at the end, or the largest |y|, as the study defines
  double heading_deg = 0;             // at the end, > 0 to the left
  double tilt_deg = 0;                // largest angle of the trunk against the vertical
  double hottest_celsius = 0;         // hottest winding at the end
  std::vector<double> per_cycle_deg = {};  // rotation in each gait cycle, where a study measures it
  bool caught = false;
  double grasp_mm = 0;  // distance of the ball from the grasp center at the end
  std::vector<std::pair<double, double>> path = {};  // trunk positions, mm, every 0.2 s
  std::map<std::string, double> reported = {};       // values reported by the robot, by name
};

struct EpisodeKey {
  std::string row, variant;  // variant: dynamics or mcu, as the study compares them
  std::uint64_t seed = 0;
  auto operator<=>(const EpisodeKey&) const = default;
};

// `error`: why the episode has no valid outcome; empty: it has one.
struct Episode {
  Outcome outcome;
  std::string error;
};

class EpisodeFile {
 public:
  // Reads the episodes of the file; a missing file has none. Removes an incomplete last line, left by an
  // interrupted program. `motors`: name of the motor parameters. Returns Fault::usage for invalid lines or
  // episodes with other motors, Fault::environment without write permission.
  static Result<EpisodeFile> open(const std::string& path, const std::string& motors);

  bool has(const EpisodeKey& key) const { return episodes_.contains(key); }
  // Adds the episode and appends it to the file.
  Result<void> add(const EpisodeKey& key, const Episode& episode);
  // Returns the outcomes by seed, without episodes that ended in an error.
  std::vector<Outcome> outcomes(const std::string& row, const std::string& variant) const;
  int errors(const std::string& row, const std::string& variant) const;
  // Returns the number of different seeds.
  std::size_t seeds() const;

 private:
  std::string path_, motors_;
  std::map<EpisodeKey, Episode> episodes_;
};

}  // namespace kaz::studies
