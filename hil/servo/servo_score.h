// Scores a servo's model by logs: error by motion, gain, mass and arm, beside the repeatability of the logs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "hil/servo/servo_fit.h"

namespace kaz::hil {

// Errors and floors of a group of logs, rad. NaN: unknown.
struct GroupScore {
  std::string kind, name;  // such as "motion", "lift_and_drop"; kinds: all, motion, gain, mass, arm
  std::size_t logs = 0;
  double error_rad = 0;    // mean of |predicted - measured| over all samples
  double trimmed_rad = 0;  // the same without strays
  // Repeatability: mean distance of each log from the median of its repeats. A deterministic model cannot be
  // better. NaN if no log of the group has repeats.
  double floor_rad = std::numeric_limits<double>::quiet_NaN();
};

// A motion that the model predicts worse than twice the larger of its floor and 5 mrad.
struct ModelGap {
  std::string motion;
  std::string
      phase;  // "torque off", "moving goal" or "resting goal": the one with the largest error
  double error_rad = 0, phase_rad = 0, limit_rad = 0;
};

struct ServoScore {
  std::vector<GroupScore> groups;   // the group "all" first
  std::vector<std::string> strays;  // names of logs that end more than 0.15 rad from their repeats
  std::vector<ModelGap> gaps;       // empty: the model is complete
};

// Indices of logs with the same rig, gain, motion and goals. Each log is in one group.
std::vector<std::vector<std::size_t>> repeats_of(const std::vector<ServoLog>& logs);

ServoScore score_of(const ServoFit& fit, const std::vector<ServoLog>& logs);

}  // namespace kaz::hil
