// Outcomes of a walking robot's episodes in a file of JSON lines, so that a study can be resumed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::studies {

// Trunk pose at the end relative to the start of the motion; x ahead, y to the left.
struct Outcome {
  bool fell = false;
  double seconds = 0;                 // duration of the motion, ramps included
  double forward_m = 0, aside_m = 0;  // aside: at the end, or the largest |y|, as the study defines
  double heading_deg = 0;             // at the end, > 0 to the left
  double tilt_deg = 0;                // largest angle of the trunk against the vertical
  double hottest_celsius = 0;         // hottest winding at the end
  std::vector<double> per_cycle_deg = {};  // rotation in each gait cycle, where a study measures it
  bool caught = false;
  double grasp_mm = 0;  // distance of the ball from the grasp centre at the end
  std::vector<std::pair<double, double>> path = {};  // of the trunk, mm, every 0.2 s
  std::map<std::string, double> reported = {};       // the robot's own estimates, by name
};

struct EpisodeKey {
  std::string row, variant;  // variant: dynamics or mcu, as the study compares them
  std::uint64_t seed = 0;
  auto operator<=>(const EpisodeKey&) const = default;
};

// `error` is empty, or why the episode has no valid outcome.
struct Episode {
  Outcome outcome;
  std::string error;
};

class EpisodeFile {
 public:
  // Reads the episodes of the file; none where it does not exist. An incomplete last line, left by an
  // interrupted program, is cut off. `motors` names the motor parameters; episodes of others are not mixed
  // in. Errors: unreadable lines, other motors (usage), no write permission (environment).
  static Result<EpisodeFile> open(const std::string& path, const std::string& motors);

  bool has(const EpisodeKey& key) const { return episodes_.contains(key); }
  // Appends it to the file, too.
  Result<void> add(const EpisodeKey& key, const Episode& episode);
  // By seed, without those that ended in an error.
  std::vector<Outcome> outcomes(const std::string& row, const std::string& variant) const;
  int errors(const std::string& row, const std::string& variant) const;
  // Number of different seeds.
  std::size_t seeds() const;

 private:
  std::string path_, motors_;
  std::map<EpisodeKey, Episode> episodes_;
};

}  // namespace kaz::studies
